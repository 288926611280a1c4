#include "engine/topology/closed_path.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;

std::string complaint(const Connectivity& c, const std::vector<Index>& vertices) {
    try {
        closed_path(c, vertices);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(ClosedPath, RunsThroughItsVertices) {
    const SurfaceMesh torus = testing::bumpy_torus(5, 4);
    for (const std::vector<Index>& vertices :
         {std::vector<Index>{0, 1, 2, 3}, std::vector<Index>{16, 12, 8, 4, 0}, std::vector<Index>{0, 4, 5}}) {
        const EdgePath path = closed_path(torus.connectivity, vertices);
        std::vector<Index> expected = vertices;
        expected.push_back(vertices.front());
        EXPECT_EQ(vertices_of(torus.connectivity, path), expected);
        for (std::size_t i = 0; i < path.size(); ++i)
            EXPECT_EQ(step_head(torus.connectivity, path[i]),
                      step_tail(torus.connectivity, path[(i + 1) % path.size()]));
    }
}

TEST(ClosedPath, RunsAlongTheBoundaryBothWays) {
    const SurfaceMesh square = testing::wavy_square(1);  // vertices 0 1 / 2 3
    const Connectivity& c = square.connectivity;
    for (const std::vector<Index>& vertices :
         {std::vector<Index>{0, 1, 3, 2}, std::vector<Index>{0, 2, 3, 1}}) {
        const EdgePath path = closed_path(c, vertices);
        ASSERT_EQ(path.size(), 4U);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_EQ(step_tail(c, path[i]), vertices[i]);
            EXPECT_EQ(step_head(c, path[i]), vertices[(i + 1) % 4]);
            EXPECT_EQ(c.twin[at(halfedge_of(path[i]))], kNoTwin);
            EXPECT_EQ(path[i] < 0, path[0] < 0) << "one way along all boundary halfedges";
        }
    }
}

TEST(ClosedPath, NamesTheVerticesThatDoNotFit) {
    const SurfaceMesh torus = testing::bumpy_torus(5, 4);
    EXPECT_NE(complaint(torus.connectivity, {0, 1, 7, 3}).find("vertices 1 and 7 are not joined"),
              std::string::npos);
    EXPECT_NE(complaint(torus.connectivity, {0, 1, 20}).find("vertex 20 is out of range"), std::string::npos);
    EXPECT_NE(complaint(torus.connectivity, {-1, 1, 2}).find("vertex -1"), std::string::npos);
    EXPECT_NE(complaint(torus.connectivity, {0, 1, 2, 3, 0}).find("not repeated"), std::string::npos);
    EXPECT_NE(complaint(torus.connectivity, {}), "");
    const Connectivity folded = testing::folded_square(1.0).connectivity;
    EXPECT_NE(
        complaint(testing::one_vertex_torus(1.0, 1.1, 1.3).connectivity, {0}).find("more than one edge"),
        std::string::npos);
    EXPECT_NE(complaint(folded, {0}).find("more than one"), std::string::npos) << "a loop has two directions";
}

}  // namespace
}  // namespace ricci
