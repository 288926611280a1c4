// Signals as batch systems send them: twice at once, and at any moment.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "engine/linear/ordering_failure.h"
#include "tests/support/digests.h"
#include "tests/support/program.h"

namespace ricci {
namespace {

using ricci::testing::digests;
using ricci::testing::make;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;

/// Signals while surfaces are read, ordered and factorised change no result.
TEST(Signals, AnyMomentIsAsGoodAsAnother) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 30000);
    const std::vector<std::string> whole{"sweep", mesh, "--vertices", "sample:30", "-o"};
    std::vector<std::string> plain = whole, stopped = whole;
    plain.push_back(folder / "plain.h5");
    stopped.insert(stopped.end(), {folder / "stopped.h5", "--resume"});
    ASSERT_EQ(run_ricci(folder, plain).status, 0);
    int stops = 0;
    for (int moment = 20; moment < 600; moment += 45)
        stops += run_ricci(folder, stopped, moment, SIGTERM).status == 128 + SIGTERM ? 1 : 0;
    EXPECT_GT(stops, 0);
    EXPECT_EQ(run_ricci(folder, stopped).status, 0);
    EXPECT_EQ(digests(folder / "stopped.h5"), digests(folder / "plain.h5"));
}

#ifdef RICCI_HAS_CHOLMOD

void (*handler_of(int number))(int) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    return action.sa_handler;
}

/// METIS that gets no memory says so, and leaves signals alone: 0 where it does.
int order_without_memory() {
    using Order = int (*)(int*, int*, int*, int*, int*, int*, int*);
    const auto order = reinterpret_cast<Order>(::dlsym(RTLD_DEFAULT, "METIS_NodeND"));
    if (order == nullptr) return 2;
    int vertices = 40000000;
    const auto size = static_cast<std::size_t>(vertices) + 1;
    const std::unique_ptr<int, decltype(&std::free)> start(
        static_cast<int*>(std::calloc(3 * size, sizeof(int))), &std::free);
    int none = 0;
    const auto terminate = handler_of(SIGTERM), abort = handler_of(SIGABRT);
    rlimit limits{};
    ::getrlimit(RLIMIT_AS, &limits);
    limits.rlim_cur = std::size_t{1} << 30U;
    if (::setrlimit(RLIMIT_AS, &limits) != 0) return 3;
    const int status =
        order(&vertices, start.get(), &none, nullptr, nullptr, start.get() + size, start.get() + 2 * size);
    if (status == 1 || !take_ordering_failure() || take_ordering_failure()) return 4;
    return handler_of(SIGTERM) == terminate && handler_of(SIGABRT) == abort ? 0 : 5;
}

TEST(Signals, MetisWithoutMemoryFailsAndTouchesNoHandler) {
    EXPECT_EXIT(std::_Exit(order_without_memory()), ::testing::ExitedWithCode(0), "");
}

#endif

}  // namespace
}  // namespace ricci
