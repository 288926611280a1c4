// Orderings that a library could not finish and does not tell of.
#pragma once

namespace ricci {

/// Of the calling thread: to be called by whoever learns that an ordering could not be finished.
void note_ordering_failure() noexcept;
/// Whether that happened since the last call on this thread.
[[nodiscard]] bool take_ordering_failure() noexcept;

}  // namespace ricci
