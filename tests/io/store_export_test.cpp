// What other programs read: h5py, CSV.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "io/store/durable.h"
#include "tests/io/python_scripts.h"

namespace ricci {
namespace {

using namespace store_samples;

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

TEST(StoreExport, RefusesAFolderThatIsNotThere) {
    EXPECT_THROW(export_csv("/no/such/folder/a.csv", StoredRun()), FileError);
}

}  // namespace
}  // namespace ricci
