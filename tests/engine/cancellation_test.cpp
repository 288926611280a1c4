// Ending computations that are no solves.
#include "engine/flow/cancellation.h"

#include <gtest/gtest.h>

#include "engine/shape_space/length_spectrum.h"
#include "engine/structure/surface_structure.h"
#include "engine/surfaces/generate.h"

namespace ricci {
namespace {

SurfaceMesh eight() {
    GenerateOptions options;
    options.faces = 500;
    return generate("eight", options);
}

TEST(Cancellation, NothingAsksWithoutAScope) {
    EXPECT_NO_THROW(cancellation_point());
}

TEST(Cancellation, ScopesNestAndEnd) {
    bool outer = false;
    const CancellationScope scope([&] { return outer; });
    {
        const CancellationScope inner([] { return true; });
        EXPECT_THROW(cancellation_point(), Cancelled);
    }
    EXPECT_NO_THROW(cancellation_point());
    outer = true;
    EXPECT_THROW(cancellation_point(), Cancelled);
    EXPECT_NO_THROW(cancellation_point(std::int64_t{1}));
    EXPECT_THROW(cancellation_point(std::int64_t{1} << 16U), Cancelled);
}

TEST(Cancellation, AStructureEndsBetweenItsStages) {
    const SurfaceMesh mesh = eight();
    int asked = 0;
    const CancellationScope scope([&] { return ++asked == 3; });
    EXPECT_THROW(make_surface_structure(mesh, {}), Cancelled);
    EXPECT_EQ(asked, 3);
}

TEST(Cancellation, ASpectrumEndsInItsLoop) {
    const SurfaceMesh mesh = eight();
    const CoarseSurface surface = coarse_surface_of(mesh, solve_sharply(mesh, {}), true);
    SpectrumOptions options;
    options.max_length = 12.0;  // more edges of the universal cover than could be crossed
    int asked = 0;
    const CancellationScope scope([&] { return ++asked == 2; });
    EXPECT_THROW(length_spectrum(surface, options), Cancelled);
}

}  // namespace
}  // namespace ricci
