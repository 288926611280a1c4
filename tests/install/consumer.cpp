// Uses one function of each installed library; exit status 0 when a genus-two surface survives the round
// trip.
#include "engine/surfaces/generate.h"
#include "io/mesh/mesh_file.h"
#include "kernels/surface_mesh.h"

int main(int, char** argv) {
    ricci::save_mesh(argv[1], ricci::generate("eight", {}));
    const ricci::LoadedMesh loaded = ricci::load_mesh(argv[1]);
    return loaded.components.size() == 1 && ricci::topology_of(loaded.components[0].connectivity).genus == 2
               ? 0
               : 1;
}
