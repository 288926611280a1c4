// METIS installs handlers of SIGTERM and SIGABRT while it orders, for errors of its own that it raises, and
// puts the old ones back in a form that works only once. A SIGTERM that comes meanwhile jumps out of the
// ordering, or, where another thread gets it, through a jump buffer that this thread does not have: the
// process crashes (measured, METIS 5.1); a SIGABRT of anybody is swallowed. Batch systems send the one at any
// moment, and the other means that the process is not sound. So in this program the old form of signal() that
// METIS calls leaves both alone (nothing else calls it), and METIS's errors jump where they should without a
// signal. CHOLMOD does not look at what METIS returns, and would go on with any ordering: it is noted that
// there is none.
//
// For executables only: never part of a library, whose users' signals are their own business.
#ifdef RICCI_HAS_CHOLMOD

#include <dlfcn.h>

#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "engine/linear/ordering_failure.h"

extern "C" {

// NOLINTNEXTLINE(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's name
sighandler_t __sysv_signal(int number, sighandler_t handler) noexcept {
    struct sigaction old {};
    if (number == SIGTERM || number == SIGABRT)
        return sigaction(number, nullptr, &old) == 0 ? old.sa_handler : SIG_ERR;
    struct sigaction wanted {};
    wanted.sa_handler = handler;
    wanted.sa_flags = SA_RESETHAND | SA_NODEFER;  // as glibc's
    return sigaction(number, &wanted, &old) == 0 ? old.sa_handler : SIG_ERR;
}

// GKlib's, through which METIS says that it cannot go on (memory): it raises `number` there.
// NOLINTNEXTLINE(cert-dcl50-cpp): its form
void gk_errexit(int number, const char* format, ...) {
    va_list values;
    va_start(values, format);
    std::vfprintf(stderr, format, values);  // NOLINT(clang-analyzer-valist.Uninitialized): false
    va_end(values);
    std::fputc('\n', stderr);
    ricci::note_ordering_failure();
    // METIS's own handler: back to where it was called, on this thread.
    using Throw = void (*)(int);
    if (const auto leave = reinterpret_cast<Throw>(dlsym(RTLD_DEFAULT, "gk_sigthrow"))) leave(number);
    std::abort();
}
}

#endif
