#include "engine/app/app.h"

int main(int argc, char** argv) {
    return ricci::app::run(argc, argv);
}
