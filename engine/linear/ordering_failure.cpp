#include "engine/linear/ordering_failure.h"

#include <utility>

namespace ricci {
namespace {

thread_local bool failed = false;

}  // namespace

void note_ordering_failure() noexcept {
    failed = true;
}

bool take_ordering_failure() noexcept {
    return std::exchange(failed, false);
}

}  // namespace ricci
