// Meshes in memory are checked as those of files are.
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "io/mesh/mesh_file.h"

namespace ricci {
namespace {

const std::vector<Point> kPoints{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kTetrahedron{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

/// What load_mesh says of the same elements.
LoadedMesh from_file(const std::vector<Point>& points, const std::vector<Triangle>& triangles) {
    std::ostringstream text;
    text.precision(17);
    text << "OFF\n" << points.size() << " " << triangles.size() << " 0\n";
    for (const Point& p : points) text << p[0] << " " << p[1] << " " << p[2] << "\n";
    for (const Triangle& t : triangles) text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    return load_mesh_bytes("mesh.off", text.str());
}

std::vector<std::string> codes(const std::vector<Defect>& defects) {
    std::vector<std::string> list;
    for (const Defect& d : defects) list.push_back(d.code + " " + std::to_string(d.index));
    return list;
}

TEST(CheckMesh, ASoundMeshIsThatOfTheFile) {
    const LoadedMesh mesh = check_mesh("mesh", kPoints, kTetrahedron),
                     other = from_file(kPoints, kTetrahedron);
    ASSERT_EQ(mesh.components.size(), 1U);
    EXPECT_EQ(mesh.stem, "mesh");
    EXPECT_EQ(mesh.components[0].points, kPoints);
    EXPECT_EQ(mesh.components[0].connectivity.tail, other.components[0].connectivity.tail);
    EXPECT_EQ(mesh.components[0].edge_length, other.components[0].edge_length);
    EXPECT_EQ(mesh.report.genus, 0);
    EXPECT_EQ(mesh.content_hash, mesh_hash(kPoints, kTetrahedron));
}

TEST(CheckMesh, DefectsAreThoseOfTheFile) {
    std::vector<std::vector<Triangle>> broken(4, kTetrahedron);
    broken[0][0] = {0, 1, 2};  // turned over
    broken[1][2][1] = 7;       // names nothing
    broken[2].push_back({0, 1, 2});
    broken[3][1] = {1, 1, 3};
    for (const std::vector<Triangle>& triangles : broken) {
        const LoadedMesh mesh = check_mesh("mesh", kPoints, triangles), other = from_file(kPoints, triangles);
        EXPECT_TRUE(mesh.components.empty());
        EXPECT_FALSE(mesh.report.errors.empty());
        EXPECT_EQ(codes(mesh.report.errors), codes(other.report.errors));
    }
}

TEST(CheckMesh, WhatFilesCannotHold) {
    std::vector<Point> points = kPoints;
    points[2][1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(codes(check_mesh("mesh", points, kTetrahedron).report.errors),
              std::vector<std::string>{"not_finite 2"});
    EXPECT_EQ(codes(check_mesh("mesh", kPoints, {}).report.errors), std::vector<std::string>{"no_faces -1"});
    std::vector<Triangle> negative = kTetrahedron;
    negative[0][0] = -1;
    EXPECT_EQ(codes(check_mesh("mesh", kPoints, negative).report.errors),
              std::vector<std::string>{"index_out_of_range 0"});
}

TEST(CheckMesh, RepairsOnlyWhatWasAsked) {
    std::vector<Triangle> turned = kTetrahedron;
    turned[0] = {0, 1, 2};
    RepairOptions repair;
    repair.orient = true;
    const LoadedMesh mesh = check_mesh("mesh", kPoints, turned, repair);
    ASSERT_EQ(mesh.components.size(), 1U);
    EXPECT_EQ(mesh.report.genus, 0);
}

TEST(CheckMesh, HashesTellMeshesApart) {
    std::vector<Point> points = kPoints;
    points[0][0] = -0.0;
    EXPECT_NE(mesh_hash(points, kTetrahedron), mesh_hash(kPoints, kTetrahedron));
    std::vector<Triangle> turned = kTetrahedron;
    turned[0] = {2, 1, 0};
    EXPECT_NE(mesh_hash(kPoints, turned), mesh_hash(kPoints, kTetrahedron));
}

}  // namespace
}  // namespace ricci
