#include "engine/flow/cancellation.h"

#include <utility>

namespace ricci {
namespace {

thread_local const std::function<bool()>* asked = nullptr;

}  // namespace

CancellationScope::CancellationScope(std::function<bool()> stop)
    : stop_(std::move(stop)), before_(std::exchange(asked, &stop_)) {}

CancellationScope::~CancellationScope() {
    asked = before_;
}

void cancellation_point() {
    if (asked != nullptr && *asked && (*asked)()) throw Cancelled();
}

}  // namespace ricci
