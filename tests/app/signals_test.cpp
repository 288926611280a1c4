// Signals as batch systems send them: twice at once, and at any moment.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

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

}  // namespace
}  // namespace ricci
