// Blocks in the formats of other programs. What the program makes of results is tested in tests/handover.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "io/exchange/gltf.h"
#include "io/exchange/npz.h"
#include "io/exchange/staged_file.h"
#include "io/exchange/vertex_normals.h"
#include "io/exchange/vtk_hdf.h"
#include "io/exchange/vtk_xml.h"
#include "tests/io/exchange_samples.h"

namespace ricci {
namespace {

using namespace exchange_samples;

constexpr const char* kReadWithVtk = R"(
import sys, struct, math
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLPolyDataReader
for reader, path in ((vtkXMLPolyDataReader(), sys.argv[1]), (vtkXMLUnstructuredGridReader(), sys.argv[2])):
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetNumberOfPoints() == 6 and grid.GetNumberOfCells() == 3, path
    assert grid.GetCell(2).GetNumberOfPoints() == 4 and grid.GetCellType(0) == 5 and grid.GetCellType(2) in (7, 9)
    u = grid.GetPointData().GetArray('u & "v" <1>')
    assert u.GetInformation().Get(vtkDataArray.UNITS_LABEL()) == 'rad'
    assert [struct.pack('d', u.GetValue(i)) for i in (0, 2, 3)] == [struct.pack('d', x) for x in (0.1, -0.0, 1e-310)]
    assert math.isnan(u.GetValue(1)) and grid.GetPoint(4) == (2, 0, 5e-324) and grid.GetPoint(5)[2] == 1e300
    assert grid.GetPointData().GetTCoords().GetName() == 'uv'
    cell = grid.GetCellData()
    assert [cell.GetArray('number').GetValue(i) for i in range(3)] == [-1, 0, 2147483647]
    assert [cell.GetArray('kind').GetValue(i) for i in range(3)] == [0, 1, 255]
    assert [cell.GetAbstractArray('name').GetValue(i) for i in range(3)] == ['a', '', '\u00fc \\xff']
    whole = grid.GetFieldData().GetArray('whole')
    assert [whole.GetValue(i) for i in range(2)] == [2.5, 1e-3]
print('good')
)";

TEST(Exchange, VtkReadsBlocks) {
    if (!has_module("vtkmodules.vtkIOXML")) GTEST_SKIP() << kPython << " has no VTK";
    const TemporaryFolder folder;
    save_vtk_xml(folder.file("a.vtp"), sample_block());
    save_vtk_xml(folder.file("a.vtu"), sample_block());
    EXPECT_EQ(run_python(folder, kReadWithVtk, folder.file("a.vtp") + " " + folder.file("a.vtu")), "good\n");
}

constexpr const char* kReadNpz = R"(
import sys, zipfile, numpy as np
assert zipfile.ZipFile(sys.argv[1]).testzip() is None
a = np.load(sys.argv[1])
assert a.files == ['block/x', 'number', 'byte', 'none'], a.files
assert a['block/x'].tobytes() == np.array([[0.1, -0.0], [1e-310, np.inf], [3, 4]]).tobytes()
assert a['number'].dtype == '<i4' and a['number'].tolist() == [-1, 5] and a['byte'].tolist() == [255]
assert a['none'].shape == (0, 3)
print('good')
)";

TEST(Exchange, NumpyLoadsArchives) {
    if (!has_module("numpy")) GTEST_SKIP() << kPython << " has no numpy";
    const TemporaryFolder folder;
    NpzFile file(folder.file("a.npz"));
    const std::vector<double> x = {0.1, -0.0, 1e-310, std::numeric_limits<double>::infinity(), 3, 4};
    const std::vector<std::int32_t> number = {-1, 5};
    const std::vector<std::uint8_t> byte = {255};
    file.add("block/x", x, {3, 2});
    file.add("number", number, {2});
    file.add("byte", byte, {1});
    file.add("none", std::span<const double>(), {0, 3});
    EXPECT_THROW(file.add("wrong", x, {4}), std::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.npz")));  // not before it is whole
    file.close();
    EXPECT_EQ(run_python(folder, kReadNpz, folder.file("a.npz")), "good\n");
}

TEST(Exchange, StagedFilesAppearWholeOrNotAtAll) {
    const TemporaryFolder folder;
    {
        StagedFile file(folder.file("a"));
        file.write("half");
    }
    EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(folder.file("a")).parent_path()));
    StagedFile file(folder.file("a"));
    const std::string large(3U << 20U, 'x');
    file.write("head ");
    file.write(large);
    file.write(" tail");
    EXPECT_EQ(file.position(), large.size() + 10);
    file.close();
    EXPECT_EQ(read_text(folder.file("a")), "head " + large + " tail");
    EXPECT_THROW(StagedFile("/no/such/folder/a"), FileError);
}

TEST(Exchange, BlocksThatDoNotFitAreRefused) {
    const TemporaryFolder folder;
    const auto refused = [&](const std::function<void(GeometryBlock&)>& spoil) {
        GeometryBlock block = sample_block();
        spoil(block);
        EXPECT_THROW(save_vtk_xml(folder.file("a.vtp"), block), std::invalid_argument);
        EXPECT_THROW(save_vtkhdf(folder.file("a.vtkhdf"), block), std::invalid_argument);
    };
    refused([](GeometryBlock& b) { b.corners[3] = 6; });
    refused([](GeometryBlock& b) { b.corners[3] = -1; });
    refused([](GeometryBlock& b) { b.first.back() = 9; });
    refused([](GeometryBlock& b) { b.first[1] = 2; });
    refused([](GeometryBlock& b) { b.points[0][1] = std::numeric_limits<double>::infinity(); });
    refused([](GeometryBlock& b) { std::get<std::vector<double>>(b.point_data[0].values).pop_back(); });
    refused([](GeometryBlock& b) { b.cell_data[1].name = "number"; });
    refused([](GeometryBlock& b) { b.cell_data[1].name = "a/b"; });
    refused([](GeometryBlock& b) { b.texture = "u & \"v\" <1>"; });
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.vtp")));
    EXPECT_THROW(save_vtk_xml(folder.file("a.stl"), sample_block()), FileError);
    EXPECT_THROW(save_vtk_xml("/no/such/folder/a.vtp", sample_block()), FileError);
}

TEST(Exchange, NormalsOfACubeCornerAreItsDiagonal) {
    GeometryBlock block;
    block.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    // The last triangle has a copy of the corner.
    for (const std::array<Index, 3>& cell :
         {std::array<Index, 3>{0, 2, 1}, std::array<Index, 3>{0, 1, 3}, std::array<Index, 3>{4, 3, 2}})
        block.add_cell(cell);
    const std::vector<Index> identity = {0, 1, 2, 3, 0};
    const std::vector<Point> whole = vertex_normals(block, identity), cut = vertex_normals(block, {});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(whole[0][k], -std::sqrt(1.0 / 3), 1e-15);
    EXPECT_EQ(whole[0], whole[4]);
    EXPECT_EQ(cut[4], (Point{-1, 0, 0}));
}

TEST(Exchange, GltfRefusesWhatItCannotHold) {
    const TemporaryFolder folder;
    GltfDocument document;
    document.materials.emplace_back();
    document.meshes = {{"m", {{}}}};
    document.scenes = {{"s", {{"n", 0, std::nullopt, 1.0, nullptr}}}};
    GltfPrimitive& primitive = document.meshes[0].primitives[0];
    const std::string path = folder.file("a.glb");
    EXPECT_THROW(save_gltf(path, document), std::invalid_argument);  // no points
    primitive.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    primitive.indices = {0, 1, 3};
    EXPECT_THROW(save_gltf(path, document), std::invalid_argument);
    primitive.indices = {0, 1, 2};
    primitive.points[0][0] = 1e39;
    EXPECT_THROW(save_gltf(path, document), std::invalid_argument);
    primitive.points[0][0] = 1e38;
    primitive.colours = {kWhite};
    EXPECT_THROW(save_gltf(path, document), std::invalid_argument);
    primitive.colours.clear();
    primitive.attributes = {{"CURVATURE", "", 1, std::vector<double>(3)}};
    EXPECT_THROW(save_gltf(path, document), std::invalid_argument);
    primitive.attributes[0].name = "_CURVATURE";
    EXPECT_FALSE(std::filesystem::exists(path));
    save_gltf(path, document);
    EXPECT_TRUE(std::filesystem::exists(path));
    EXPECT_THROW(save_gltf(folder.file("a.gl"), document), FileError);
}

}  // namespace
}  // namespace ricci
