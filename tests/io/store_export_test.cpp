// What other programs read: h5py, ParaView's formats, CSV.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "io/store/durable.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;

constexpr const char* kPython = "/usr/bin/python3";

bool has_module(const std::string& module) {
    const std::string command = fmt::format("{} -c 'import {}' 2>/dev/null", kPython, module);
    return std::system(command.c_str()) == 0;  // NOLINT(concurrency-mt-unsafe): one thread
}

// Runs a script with arguments; its output, with the exit status in front when that is not 0.
std::string run_python(const TemporaryFolder& folder, const std::string& script,
                       const std::string& arguments) {
    const std::string path = folder.file("script.py");
    std::ofstream(path) << script;
    const std::string command = fmt::format("{} {} {} 2>&1", kPython, path, arguments);
    std::FILE* pipe = ::popen(command.c_str(), "r");
    std::string output;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
    const int status = ::pclose(pipe);
    return status == 0 ? output : fmt::format("status {}: {}", status, output);
}

constexpr const char* kReadWithH5py = R"(
import sys, h5py, numpy as np
with h5py.File(sys.argv[1]) as h:
    text = 'format software software_version git command config host created fingerprint'.split()
    assert all(isinstance(h.attrs[k], str) for k in text), {k: type(h.attrs[k]) for k in text}
    assert h.attrs['format'] == 'ricci' and h.attrs['format_version'] == 1 and h.attrs['complete'] == 1
    assert h.attrs['config'] == '[sweep]\nvertices = "all"\n' and h.attrs['threads'] == 2
    assert list(h['items']) == ['a@32', 'b@18']
    g = h['items/a@32']
    assert g.attrs['source'] == 'meshes/a@32.off' and g.attrs['units'] == 'mm' and g.attrs['vertices'] == 16
    kinds = {'vertex': 'i4', 'area_distortion': 'f8', 'newton_iterations': 'u2', 'residual_max': 'f8',
             'flips': 'i4', 'seconds': 'f4', 'status': 'u1', 'gauss_bonnet_error': 'f8',
             'precision_digits': 'i4'}
    for k, d in kinds.items():
        assert g['sweep'][k].dtype == np.dtype('<' + d) and g['sweep'][k].shape == (16,), k
    e = h5py.check_enum_dtype(g['sweep/status'].dtype)
    assert e['converged'] == 0 and e['internal_error'] == 11 and len(e) == 12, e
    s, d = g['sweep/status'][:], g['sweep/area_distortion'][:]
    assert (np.isfinite(d) == (s == e['converged'])).all()
    v = g['sweep/vertex'][:]
    assert int(g['sweep/best/vertex'][()]) == v[np.nanargmin(d)] and g['sweep/best/vertex'].dtype == '<i4'
    assert int(g['sweep/worst/vertex'][()]) == v[np.nanargmax(d)]
    assert g['sweep/worst/area_distortion'][()] == np.nanmax(d)
    assert g['sweep/best/conformal_factor'].shape == (16,)
    assert g['sweep/kept/vertex'].shape == (3,) and g['sweep/kept/conformal_factor'].shape == (3, 16)
    assert g['mesh/points'].shape == (16, 3) and g['mesh/triangles'].shape == (32, 3)
    assert g['mesh/triangles'].dtype == '<i4' and g['mesh/points'].dtype == '<f8'
    f = g['flow']
    assert f.attrs['geometry'] == 'euclidean' and f.attrs['status'] == 1 and f.attrs['doubled'] == 1
    assert h5py.check_enum_dtype(f.attrs.get_id('status').dtype) == e
    assert f['twin'].shape == (96,) and f['log/step'].shape == (3,)
    t = h['failures']
    assert t.dtype.names == ('item', 'stage', 'status', 'message') and t.shape == (1,)
    assert t[0]['message'].decode() == 'c.off: line 3: not a number'
print('good')
)";

TEST(StoreExport, H5pyReadsIt) {
    if (!has_module("h5py")) GTEST_SKIP() << kPython << " has no h5py";
    const TemporaryFolder folder;
    write_sample_run(folder.file("run.h5"), false);
    EXPECT_EQ(run_python(folder, kReadWithH5py, folder.file("run.h5")), "good\n");
}

TEST(StoreExport, Csv) {
    const TemporaryFolder folder;
    StoredRun run;
    run.info = sample_info();
    StoredItem item;
    item.item.name = "a, \"b\"@8";
    item.sweep.emplace();
    item.sweep->rows = {sample_row(3), sample_row(4)};
    item.sweep->rows[0].area_distortion = 0.1;
    run.items = {item, StoredItem()};
    export_csv(folder.file("rows.csv"), run);
    EXPECT_EQ(read_text(folder.file("rows.csv")),
              "item,vertex,status,area_distortion,newton_iterations,residual_max,flips,seconds,"
              "gauss_bonnet_error,precision_digits\n"
              "\"a, \"\"b\"\"@8\",3,converged,0.1,8,2.5e-12,9,0.25,0.75,19\n"
              "\"a, \"\"b\"\"@8\",4,max_iterations,nan,9,2e-12,12,0.25,1,16\n");
}

std::vector<PointField> sample_fields(const ItemRecord& item) {
    PointField field{"u & \"v\" <1>", {}};
    for (Index v = 0; v < item.vertices; ++v) field.values.push_back(v / 3.0);
    return {field, {"zero", std::vector<double>(static_cast<std::size_t>(item.vertices), 0.0)}};
}

constexpr const char* kReadVtu = R"(
import sys, base64, struct, xml.etree.ElementTree as ET
root = ET.parse(sys.argv[1]).getroot()
assert root.tag == 'VTKFile' and root.get('header_type') == 'UInt64'
piece = root.find('UnstructuredGrid/Piece')
n, f = int(piece.get('NumberOfPoints')), int(piece.get('NumberOfCells'))
def values(a, letter):
    raw = base64.b64decode(a.text)
    size, = struct.unpack_from('<Q', raw)
    assert size == len(raw) - 8
    return struct.unpack_from('<%d%s' % (size // struct.calcsize(letter), letter), raw, 8)
assert (n, f) == (16, 32)
assert len(values(piece.find('Points/DataArray'), 'd')) == 3 * n
cells = {a.get('Name'): a for a in piece.findall('Cells/DataArray')}
assert max(values(cells['connectivity'], 'i')) == n - 1
assert values(cells['offsets'], 'q') == tuple(range(3, 3 * f + 1, 3))
assert values(cells['types'], 'B') == (5,) * f
data = {a.get('Name'): values(a, 'd') for a in piece.findall('PointData/DataArray')}
assert data['u & "v" <1>'] == tuple(v / 3.0 for v in range(n)) and data['zero'] == (0.0,) * n
print('good')
)";

TEST(StoreExport, VtuIsXmlWithTheSameNumbers) {
    if (!has_module("xml.etree.ElementTree")) GTEST_SKIP() << "no " << kPython;
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    export_vtu(folder.file("a.vtu"), item, sample_fields(item));
    EXPECT_EQ(run_python(folder, kReadVtu, folder.file("a.vtu")), "good\n");
}

constexpr const char* kReadWithVtk = R"(
import sys
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkIOHDF import vtkHDFReader
for reader, path in ((vtkXMLUnstructuredGridReader(), sys.argv[1]), (vtkHDFReader(), sys.argv[2])):
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetNumberOfPoints() == 16 and grid.GetNumberOfCells() == 32, path
    assert grid.GetCellType(31) == 5 and grid.GetCell(0).GetPointId(1) == 4, path
    field = grid.GetPointData().GetArray('u & "v" <1>')
    assert [field.GetValue(v) for v in range(16)] == [v / 3.0 for v in range(16)], path
    assert grid.GetPoint(0) == (3.0, 0.0, 0.0), path
print('good')
)";

TEST(StoreExport, VtkReadsBoth) {
    if (!has_module("vtkmodules.vtkIOHDF")) GTEST_SKIP() << kPython << " has no vtk with an HDF reader";
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    export_vtu(folder.file("a.vtu"), item, sample_fields(item));
    export_vtkhdf(folder.file("a.vtkhdf"), item, sample_fields(item));
    EXPECT_EQ(run_python(folder, kReadWithVtk, folder.file("a.vtu") + " " + folder.file("a.vtkhdf")),
              "good\n");
}

constexpr const char* kReadVtkHdf = R"(
import sys, h5py
g = h5py.File(sys.argv[1])['VTKHDF']
assert list(g.attrs['Version']) == [1, 0]
t = g.attrs.get_id('Type').get_type()
assert not t.is_variable_str() and t.get_cset() == h5py.h5t.CSET_ASCII and g.attrs['Type'] == b'UnstructuredGrid'
assert list(g['NumberOfPoints']) == [16] and list(g['NumberOfCells']) == [32]
assert list(g['NumberOfConnectivityIds']) == [96] and g['Offsets'].shape == (33,) and g['Offsets'][32] == 96
print('good')
)";

TEST(StoreExport, VtkHdfLayout) {
    if (!has_module("h5py")) GTEST_SKIP() << kPython << " has no h5py";
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    export_vtkhdf(folder.file("a.vtkhdf"), item, sample_fields(item));
    EXPECT_EQ(run_python(folder, kReadVtkHdf, folder.file("a.vtkhdf")), "good\n");
}

TEST(StoreExport, RefusesWhatCannotBeShown) {
    const TemporaryFolder folder;
    ItemRecord item = sample_item("a@32", 4);
    std::vector<PointField> fields = sample_fields(item);
    EXPECT_THROW(export_vtu("/no/such/folder/a.vtu", item, fields), FileError);
    EXPECT_THROW(export_vtkhdf("/no/such/folder/a.vtkhdf", item, fields), FileError);
    EXPECT_THROW(export_csv("/no/such/folder/a.csv", StoredRun()), FileError);
    fields[1].values.pop_back();
    EXPECT_THROW(export_vtu(folder.file("a.vtu"), item, fields), std::invalid_argument);
    fields = {fields[0], fields[0]};
    EXPECT_THROW(export_vtkhdf(folder.file("a.vtkhdf"), item, fields), std::invalid_argument);
    item.points.clear();
    item.twin.resize(96);
    item.edge_length.resize(96);
    EXPECT_THROW(export_vtu(folder.file("a.vtu"), item, {}), std::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.vtu")));
}

}  // namespace
}  // namespace ricci
