// The sample meshes: every clean one loads with the counts its catalogue states, every bad one has its
// outcome.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "tests/io/mesh_test_files.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

/// A table of tab-separated columns with a header line.
std::vector<std::map<std::string, std::string>> read_table(const std::string& path) {
    std::ifstream file(path);
    std::vector<std::string> names;
    std::vector<std::map<std::string, std::string>> rows;
    for (std::string line; std::getline(file, line);) {
        std::istringstream fields(line);
        std::map<std::string, std::string> row;
        std::size_t column = 0;
        for (std::string field; std::getline(fields, field, '\t'); ++column) {
            if (rows.empty() && names.size() == column) {
                names.push_back(field);
            }
            row[names.at(column)] = field;
        }
        rows.push_back(row);
    }
    rows.erase(rows.begin());
    return rows;
}

struct BadSample {
    const char* file;
    const char* codes;  // of the errors; empty: it loads (some with notes, several components are no defect)
    Index vertices = 0, faces = 0, genus = 0, boundaries = 0, components = 0;
};

const std::vector<BadSample>& bad_samples() {
    static const std::vector<BadSample> samples = {
        {"nonmanifold/cow_pinch_vertex.obj", "non_manifold_vertex"},
        {"nonmanifold/beetle_nm_edges.obj", "non_manifold_edge"},
        {"nonmanifold/many_small_holes.ply", "non_manifold_vertex"},
        {"nonmanifold/non_manif_hole.ply", "non_manifold_vertex"},
        {"nonmanifold/triple_vierbein.obj", "non_manifold_edge unoriented"},
        {"nonmanifold/fan3.obj", "non_manifold_edge"},
        {"nonmanifold/joined_tetrahedra.obj", "duplicate_face non_manifold_edge"},
        {"nonmanifold/DoubleWedge.stl", "non_manifold_edge"},
        {"nonmanifold/camel-gallop-09_collapsed_edge.off",
         "duplicate_face non_manifold_edge non_manifold_vertex"},
        {"nonmanifold/tinker.obj", "non_manifold_edge unoriented non_manifold_vertex"},
        {"nonmanifold/ct_colon_patch_nm.off", "non_manifold_edge unoriented"},
        {"components/bones_26_components.off", "", 2154, 4204, 0, 0, 26},
        {"nonorientable/mobius_tri.obj", "non_orientable"},
        {"nonorientable/mobius_quad.obj", "non_orientable"},
        {"nonorientable/klein_bottle_quad.obj", "non_orientable"},
        {"orientation/blobby-shuffled.off", "unoriented"},
        {"orientation/oblong-shuffled.off", "unoriented"},
        {"orientation/inverted_triangles.obj", "unoriented"},
        {"orientation/tetra.obj", "unoriented"},
        {"components/teapot_4_components.obj", "non_manifold_vertex"},
        {"components/bff_teapot_5_components.obj", "", 1202, 2256, 0, 8, 5},
        {"components/blobby_3cc.off", "", 1820, 3417, 0, 4, 3},
        {"components/two_spheres.obj", "", 1060, 2112, 0, 0, 2},
        {"components/two_objects.obj", "", 12, 16, 0, 0, 2},
        {"components/letterA_isolated_vertices.off", "", 37, 51, 0, 2, 1},
        {"duplicates/soup.stl", "", 300, 100, 0, 100, 100},
        {"duplicates/cube_blender_uv.ply", "", 24, 12, 0, 6, 6},
        {"duplicates/duplicate_edge.obj", "", 6, 2, 0, 2, 2},
        {"duplicates/sub_duplicate_faces.obj", "duplicate_face non_manifold_edge"},
        {"duplicates/not_convex_unwelded.obj", "", 288, 96, 0, 96, 96},
        {"degenerate/wave.obj", "zero_area_face"},
        {"degenerate/HEART_OBS5.ply", "zero_area_face"},
        {"degenerate/capsule.obj", "zero_length_edge zero_area_face"},
        {"degenerate/zero_area_face.obj", "zero_area_face"},
        {"degenerate/zero_length_edge.obj", "zero_length_edge zero_area_face"},
        {"degenerate/degenerate_edge.obj", "repeated_vertex_in_face"},
        {"degenerate/degtri_sliding.off", "zero_area_face"},
        {"degenerate/degenerated.obj", "duplicate_face non_manifold_edge"},
        {"degenerate/cup_1e-6_degree.obj", "", 214, 424, 0, 0, 1},
        {"degenerate/mpi_triang.off", "", 90, 180, 1, 0, 1},
        {"degenerate/sliver_tet.ply", "", 4, 4, 0, 0, 1},
        {"polygons/kitten_quads_g1.obj", "", 3178, 6356, 1, 0, 1},
        {"polygons/fandisk_quads.off", "", 766, 1528, 0, 0, 1},
        {"polygons/bunny_poly.ply", "", 1241, 2478, 0, 0, 1},
        {"polygons/greek_helmet.obj", "", 5021, 9608, 0, 9, 7},
        {"polygons/torus_quad.off", "", 25, 50, 1, 0, 1},
        {"syntax/texturedknot_negative_indices.obj", "", 1440, 2880, 1, 0, 1},
        {"syntax/saddle2_negative_indices.obj", "", 741, 1352, 0, 1, 1},
        {"syntax/negative_indices.obj", "", 8, 12, 0, 0, 1},
        {"syntax/notenoughindices.obj", "too_few_corners"},
        {"syntax/cornell_box.obj", "", 68, 34, 0, 17, 17},
        {"syntax/whitespace.off", "", 8, 12, 0, 0, 1},
        {"syntax/comments.off", "", 8, 12, 0, 0, 1},
        {"syntax/hole_sphere3_comma_decimals.off", "syntax"},
        {"syntax/mesh_with_colors.off", "", 8, 6, 0, 1, 1},
        {"syntax/square_2D.obj", "syntax"},
        {"syntax/quad_s1.obj", "syntax"},
        {"formats/beetle_binary.off", "unsupported_format"},
        {"formats/sphere_binary_solid_header.stl", "", 682, 1360, 0, 0, 1},
        {"formats/icosahedron_ascii.stl", "", 12, 20, 0, 0, 1},
        {"formats/icosahedron_binary.stl", "", 12, 20, 0, 0, 1},
        {"formats/multibody_ascii.stl", "unoriented"},
        {"formats/fuze_ascii.ply", "", 502, 1000, 0, 0, 1},
        {"formats/points_emptyface.ply", "no_faces"},
        {"formats/hippo_tristrips.ply", "unsupported_format"},
        {"formats/cube_malformed.ply", "syntax"},
        {"formats/davidpts_points_only.obj", "too_few_corners no_faces"},
        {"formats/bunny.ply.gz", "", 34834, 69451, 0, 5, 1},
        {"formats/header_only.ply", "truncated"},
        {"formats/rectum_legacy_vtk.vtk", "unsupported_format"},
        {"degenerate/fixture_g10_3_degenerate.stl", "zero_area_face"},
    };
    return samples;
}

struct RepairedSample {
    const char* file;
    const char* repair;
    Index vertices, faces, genus, boundaries, components;
};

TEST(MeshSamples, EveryBadSampleHasItsOutcome) {
    RICCI_DATA_FILE_OR_SKIP(table, "BAD.tsv");
    std::set<std::string> tested;
    for (const BadSample& sample : bad_samples()) {
        RICCI_DATA_FILE_OR_SKIP(path, std::string("bad/") + sample.file);
        tested.insert(std::string("bad/") + sample.file);
        const LoadedMesh mesh = load_mesh(path);
        EXPECT_EQ(error_codes(mesh), sample.codes) << sample.file;
        EXPECT_EQ(mesh.components.empty(), !mesh.report.errors.empty()) << sample.file;
        for (const Defect& defect : mesh.report.errors) EXPECT_FALSE(defect.message.empty()) << sample.file;
        if (*sample.codes != '\0') continue;
        EXPECT_EQ(mesh.report.vertices, sample.vertices) << sample.file;
        EXPECT_EQ(mesh.report.faces, sample.faces) << sample.file;
        EXPECT_EQ(mesh.report.genus, sample.genus) << sample.file;
        EXPECT_EQ(mesh.report.boundaries, sample.boundaries) << sample.file;
        EXPECT_EQ(static_cast<Index>(mesh.components.size()), sample.components) << sample.file;
    }
    for (const auto& row : read_table(table)) EXPECT_TRUE(tested.contains(row.at("file"))) << row.at("file");
}

TEST(MeshSamples, RepairsGiveTheSurfacesTheCatalogueStates) {
    const RepairedSample samples[] = {
        {"orientation/blobby-shuffled.off", "orient", 2027, 4050, 0, 0, 1},
        {"orientation/oblong-shuffled.off", "weld,orient", 422, 840, 0, 0, 1},
        {"orientation/inverted_triangles.obj", "orient", 12577, 24685, 0, 6, 1},
        {"orientation/tetra.obj", "orient", 4, 4, 0, 0, 1},
        {"duplicates/cube_blender_uv.ply", "weld", 8, 12, 0, 0, 1},
        {"duplicates/duplicate_edge.obj", "weld", 4, 2, 0, 1, 1},
        {"degenerate/capsule.obj", "weld,drop-degenerate", 5002, 10000, 0, 0, 1},
        {"degenerate/wave.obj", "drop-degenerate", 576, 1148, 0, 0, 1},
        {"degenerate/HEART_OBS5.ply", "drop-degenerate", 2511, 5018, 0, 0, 1},
        {"degenerate/fixture_g10_3_degenerate.stl", "drop-degenerate", 5500, 11036, 10, 0, 1},
        {"degenerate/degtri_sliding.off", "drop-degenerate", 8, 8, 0, 1, 1},
        {"formats/multibody_ascii.stl", "orient", 20, 32, 0, 0, 2},
    };
    for (const RepairedSample& sample : samples) {
        RICCI_DATA_FILE_OR_SKIP(path, std::string("bad/") + sample.file);
        const LoadedMesh mesh = load_mesh(path, parse_repair(sample.repair));
        EXPECT_EQ(error_codes(mesh), "") << sample.file;
        EXPECT_FALSE(mesh.report.notes.empty()) << sample.file;
        EXPECT_EQ(mesh.report.vertices, sample.vertices) << sample.file;
        EXPECT_EQ(mesh.report.faces, sample.faces) << sample.file;
        EXPECT_EQ(mesh.report.genus, sample.genus) << sample.file;
        EXPECT_EQ(mesh.report.boundaries, sample.boundaries) << sample.file;
        EXPECT_EQ(static_cast<Index>(mesh.components.size()), sample.components) << sample.file;
    }
}

TEST(MeshSamples, WeldingNotConvexShowsItsNonManifoldEdges) {
    RICCI_DATA_FILE_OR_SKIP(path, "bad/duplicates/not_convex_unwelded.obj");
    const LoadedMesh mesh = load_mesh(path, parse_repair("weld"));
    EXPECT_EQ(error_codes(mesh), "non_manifold_edge");
    EXPECT_EQ(mesh.report.errors.size(), 12U);
    EXPECT_EQ(mesh.report.vertices, 44);
}

TEST(MeshSamples, EveryCleanSampleLoadsWithItsCounts) {
    RICCI_DATA_FILE_OR_SKIP(table, "MESHES.tsv");
    int count = 0;
    for (auto& row : read_table(table)) {
        RICCI_DATA_FILE_OR_SKIP(path, row["file"]);
        const LoadedMesh mesh = load_mesh(path);
        ++count;
        if (path.ends_with(".mesh")) {
            EXPECT_EQ(error_codes(mesh), "unsupported_format") << path;
            continue;
        }
        ASSERT_EQ(error_codes(mesh), "") << path << ": " << mesh.report.errors[0].message;
        EXPECT_EQ(mesh.components.size(), 1U) << path;
        EXPECT_EQ(mesh.report.vertices, std::stoi(row["V"])) << path;
        EXPECT_EQ(mesh.report.edges, std::stoi(row["E"])) << path;
        EXPECT_EQ(mesh.report.faces, std::stoi(row["F"])) << path;
        EXPECT_EQ(mesh.report.genus, std::stoi(row["genus"])) << path;
        EXPECT_EQ(mesh.report.boundaries, std::stoi(row["boundaries"])) << path;
        // The catalogue rounds to 6 and 4 decimals; its angles below 1e-3 degree carry errors of double
        // precision.
        EXPECT_NEAR(*mesh.report.min_angle_deg, std::stod(row["min_angle_deg"]), 2e-6) << path;
        EXPECT_NEAR(*mesh.report.obtuse_fraction, std::stod(row["obtuse_fraction"]), 5.1e-5) << path;
    }
    EXPECT_EQ(count, 133);
}

}  // namespace
}  // namespace ricci
