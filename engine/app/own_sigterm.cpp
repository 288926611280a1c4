// METIS installs a handler of SIGTERM while it orders, for errors of its own that it would raise, and puts
// the old one back in a form that works only once. A SIGTERM that comes meanwhile jumps out of the ordering,
// or, where another thread gets it, through a jump buffer that this thread does not have: the process crashes
// (measured, METIS 5.1). Batch systems send that signal at any moment. So in this program the old
// form of signal() that METIS calls leaves SIGTERM alone. Nothing else in the program calls it.
//
// For executables only: never part of a library, whose users' signals are their own business.
#include <csignal>

// NOLINTNEXTLINE(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's name
extern "C" sighandler_t __sysv_signal(int number, sighandler_t handler) noexcept {
    struct sigaction old {};
    if (number == SIGTERM) return sigaction(number, nullptr, &old) == 0 ? old.sa_handler : SIG_ERR;
    struct sigaction wanted {};
    wanted.sa_handler = handler;
    wanted.sa_flags = SA_RESETHAND | SA_NODEFER;  // as glibc's
    return sigaction(number, &wanted, &old) == 0 ? old.sa_handler : SIG_ERR;
}
