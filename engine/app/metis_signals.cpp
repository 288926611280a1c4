// METIS installs handlers of SIGTERM and SIGABRT while it orders, for errors of its own that it raises, and
// puts the old ones back in a form that works only once. A SIGTERM that comes meanwhile jumps out of the
// ordering, or, where another thread gets it, through a jump buffer that this thread does not have: the
// process crashes (measured, METIS 5.1); a SIGABRT of anybody is swallowed. Batch systems send the one at any
// moment, and the other means that the process is not sound. So here are GKlib's functions that install the
// handlers, without handlers: they only count the jump buffers. METIS's errors jump where they should without
// a signal. CHOLMOD does not look at what METIS returns, and would go on with any ordering: it is noted that
// there is none.
//
// libmetis calls all three through its linkage table, so definitions that come before its own in the order of
// search win: those of an executable that exports them, and those of a Python module for the libraries that
// are loaded with it. For these two only, never part of a library.
#ifdef RICCI_HAS_CHOLMOD

#include <dlfcn.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "engine/linear/ordering_failure.h"

namespace {

constexpr int kJumpBuffers = 128;  // GKlib's MAX_JBUFS

/// GKlib's number of the jump buffer in use on this thread, -1: none. Null where this is not GKlib.
int* current_jump_buffer() {
    return static_cast<int*>(dlsym(RTLD_DEFAULT, "gk_cur_jbufs"));
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) int gk_sigtrap() {
    int* const current = current_jump_buffer();
    if (current == nullptr || *current + 1 >= kJumpBuffers) return 0;
    ++*current;
    return 1;
}

__attribute__((visibility("default"))) int gk_siguntrap() {
    int* const current = current_jump_buffer();
    if (current == nullptr || *current < 0) return 0;
    --*current;
    return 1;
}

// GKlib's, through which METIS says that it cannot go on (memory): it raises `number` there.
// NOLINTNEXTLINE(cert-dcl50-cpp): its form
__attribute__((visibility("default"))) void gk_errexit(int number, const char* format, ...) {
    va_list values;
    va_start(values, format);
    std::vfprintf(stderr, format, values);  // NOLINT(clang-analyzer-valist.Uninitialized): false
    va_end(values);
    std::fputc('\n', stderr);
    ricci::note_ordering_failure();
    // Back to where METIS was called, on this thread.
    using Throw = void (*)(int);
    if (const auto leave = reinterpret_cast<Throw>(dlsym(RTLD_DEFAULT, "gk_sigthrow"))) leave(number);
    std::abort();
}
}

#endif
