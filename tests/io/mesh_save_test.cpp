// Written surfaces read back bit for bit.
#include <gtest/gtest.h>

#include <random>

#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

SurfaceMesh random_octahedron() {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> jitter(-0.1, 0.1);
    std::vector<Point> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0},
                                 {0, 0, 1}, {0, 0, -1}, {7, 7, 7}};
    for (Point& p : points) {
        for (double& x : p) x += jitter(random);
    }
    points[0][1] = 1e-310;  // subnormal
    const std::vector<Triangle> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                             {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return make_surface_mesh(points, triangles);
}

TEST(MeshSave, EmbeddedFormatsRoundTrip) {
    const SurfaceMesh mesh = random_octahedron();
    const TemporaryFolder folder;
    for (const char* name : {"m.off", "m.obj", "m.ply", "m.OFF"}) {
        save_mesh(folder.path(name), mesh);
        const LoadedMesh loaded = load_mesh(folder.path(name));
        ASSERT_EQ(error_codes(loaded), "") << name;
        const SurfaceMesh& back = loaded.components.at(0);
        EXPECT_EQ(back.points, mesh.points) << name;
        EXPECT_EQ(back.connectivity.tail, mesh.connectivity.tail) << name;
        EXPECT_EQ(back.connectivity.twin, mesh.connectivity.twin) << name;
        EXPECT_EQ(back.edge_length, mesh.edge_length) << name;
    }
}

TEST(MeshSave, IntrinsicFormatRoundTrips) {
    const SurfaceMesh mesh = random_octahedron();
    const TemporaryFolder folder;
    save_mesh(folder.path("m.len"), mesh);
    const LoadedMesh first = load_mesh(folder.path("m.len"));
    ASSERT_EQ(error_codes(first), "");
    const SurfaceMesh& back = first.components.at(0);
    EXPECT_TRUE(back.intrinsic());
    EXPECT_EQ(back.edge_length, mesh.edge_length);
    EXPECT_EQ(back.connectivity.tail, mesh.connectivity.tail);
    EXPECT_EQ(back.connectivity.twin, mesh.connectivity.twin);
    EXPECT_EQ(back.connectivity.edge, mesh.connectivity.edge);
    EXPECT_EQ(back.connectivity.vertex_count, 7);
    EXPECT_EQ(first.report.vertices, 6);
    save_mesh(folder.path("again.len"), back);
    EXPECT_EQ(load_mesh(folder.path("again.len")).content_hash, first.content_hash);
}

TEST(MeshSave, OneVertexTorusRoundTrips) {
    const TemporaryFolder folder;
    const LoadedMesh torus = load_bytes("t.len", torus_len());
    save_mesh(folder.path("t.len"), torus.components.at(0));
    const LoadedMesh back = load_mesh(folder.path("t.len"));
    EXPECT_EQ(back.components.at(0).connectivity.twin, torus.components[0].connectivity.twin);
    EXPECT_EQ(back.components[0].edge_length, torus.components[0].edge_length);
}

TEST(MeshSave, RefusesWhatItCannotWrite) {
    const TemporaryFolder folder;
    const SurfaceMesh mesh = random_octahedron();
    EXPECT_THROW(save_mesh(folder.path("m.stl"), mesh), FileError);
    EXPECT_THROW(save_mesh(folder.path("no/such/folder/m.off"), mesh), FileError);
    const LoadedMesh torus = load_bytes("t.len", torus_len());
    EXPECT_THROW(save_mesh(folder.path("t.off"), torus.components.at(0)), FileError);
    if (std::filesystem::exists("/dev/full")) {
        std::filesystem::create_symlink("/dev/full", folder.path("full.off"));
        EXPECT_THROW(save_mesh(folder.path("full.off"), mesh), FileError);
    }
}

}  // namespace
}  // namespace ricci
