// The index of shapes.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>

#include "engine/app/index_job.h"
#include "engine/app/index_search.h"
#include "engine/app/type_distances.h"
#include "engine/python/array_views.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "engine/python/surface.h"
#include "io/mesh/formats/file_bytes.h"
#include "io/store/durable.h"
#include "kernels/parallel.h"

namespace py = pybind11;

namespace ricci::python {
namespace {

using app::BuildOptions;
using app::IndexConfig;
using app::IndexQuery;
using app::IndexSearch;

int resolved(int threads) {
    return threads > 0 ? threads : hardware_threads();
}

/// What became of each shape: (file, component, components, reused, stage, status, message).
py::list report(const app::IndexJob& job) {
    py::list list;
    for (const app::BuiltShape& s : job.shapes)
        list.append(py::make_tuple(s.file, s.component, s.components, s.reused, s.failure.stage,
                                   s.failure.status.empty() ? "converged" : s.failure.status,
                                   s.failure.message));
    return list;
}

py::list write(const app::IndexWork& work, const std::string& output, int threads, bool resume,
               const std::string& max_memory, const py::object& progress) {
    const std::int64_t memory = max_memory.empty() ? 0 : app::parse_bytes(max_memory);
    return report(run_long(progress, [&](Call& call) {
        ReportedProgress reported(call);
        BuildOptions options;
        options.threads = resolved(threads);
        options.max_memory = memory;
        options.output = output;
        options.stop = call.stop();
        options.progress = &reported;
        return app::write_index(work, options, resume);
    }));
}

py::list build(const std::string& output, const std::vector<std::string>& paths, const IndexConfig& config,
               int threads, bool resume, const std::string& max_memory, const py::object& progress) {
    return write(app::index_of(config, paths), output, threads, resume, max_memory, progress);
}

py::list add(const std::string& index, const std::vector<std::string>& paths, int threads, bool resume,
             const std::string& max_memory, const py::object& progress) {
    return write(app::index_with(index, paths), index, threads, resume, max_memory, progress);
}

py::tuple remove(const std::string& index, const std::vector<std::string>& paths) {
    const auto removal =
        run_long(py::none(), [&](Call&) { return app::remove_from_index(index, paths, hardware_threads()); });
    return py::make_tuple(removal.removed, removal.left, removal.not_found);
}

/// An index that is asked; one question at a time.
class Search {
  public:
    Search(const std::string& path, const std::string& metric)
        : search_(path, app::parse_shape_metric(metric)) {}

    struct Answer {
        IndexQuery query;
        std::vector<std::string> file;
        std::vector<std::int32_t> component, components;
        std::vector<double> distance;
    };

    std::vector<Answer> ask_file(const std::string& file, std::size_t k, bool others,
                                 const std::function<bool()>& stop) {
        const std::lock_guard lock(mutex_);
        std::string bytes = read_text(file);
        std::vector<IndexQuery> queries = search_.known_shapes(file, checksum_of(std::string_view(bytes)));
        bool failed = false;
        if (queries.empty())
            queries = search_.describe(
                file, load_mesh_bytes(file, std::move(bytes), parse_repair(search_.config().repair)), stop,
                failed);
        return answers(queries, k, others, failed, file);
    }

    std::vector<Answer> ask_surface(const Surface& surface, std::size_t k, bool others,
                                    const std::function<bool()>& stop) {
        const std::lock_guard lock(mutex_);
        bool failed = false;
        return answers(search_.describe(surface.loaded->stem, *surface.loaded, stop, failed), k, others,
                       failed, surface.loaded->stem);
    }

  private:
    std::vector<Answer> answers(const std::vector<IndexQuery>& queries, std::size_t k, bool others,
                                bool failed, const std::string& name) {
        if (queries.empty() && failed)
            throw std::invalid_argument(name + " could not be described (the log of ricci says why)");
        std::vector<Answer> all;
        for (const IndexQuery& query : queries) {
            Answer answer{query, {}, {}, {}, {}};
            if (const IndexSearch::Type* type = search_.type(query.genus, query.boundaries))
                for (const Neighbour& n : app::neighbours_of(query, *type, k, others)) {
                    answer.file.push_back(type->bucket.files[n.shape]);
                    answer.component.push_back(type->bucket.component[n.shape]);
                    answer.components.push_back(type->bucket.components[n.shape]);
                    answer.distance.push_back(n.distance);
                }
            all.push_back(std::move(answer));
        }
        return all;
    }

    IndexSearch search_;
    std::mutex mutex_;
};

/// Per query: (name, genus, boundaries, vector, [(file, component, components, distance)]).
py::list to_python(const std::vector<Search::Answer>& answers) {
    py::list list;
    for (const Search::Answer& a : answers) {
        py::list neighbours;
        for (std::size_t k = 0; k < a.file.size(); ++k)
            neighbours.append(py::make_tuple(a.file[k], a.component[k], a.components[k], a.distance[k]));
        list.append(
            py::make_tuple(a.query.name, a.query.genus, a.query.boundaries, a.query.vector, neighbours));
    }
    return list;
}

/// A whole index in memory; arrays of its types are views.
struct Contents {
    ShapeIndex index;
    std::vector<IndexBucket> types;
};

std::shared_ptr<Contents> contents(const std::string& path) {
    return run_long(py::none(), [&](Call&) {
        auto read = std::make_shared<Contents>();
        read->index = read_shape_index(path);
        const IndexReader reader(path);
        for (const auto& [genus, boundaries] : reader.types())
            read->types.push_back(reader.bucket(genus, boundaries).value());
        return read;
    });
}

py::list entries(const py::object& self) {
    py::list list;
    for (const IndexEntry& e : self.cast<const Contents&>().index.entries) {
        const ShapeRecord& s = e.shape;
        py::dict d;
        d["file"] = e.file;
        d["component"] = s.component;
        d["components"] = s.components;
        d["genus"] = s.genus;
        d["boundaries"] = s.boundaries;
        d["vertices"] = s.vertices;
        d["faces"] = s.faces;
        d["message"] = s.message;
        d["fingerprint"] = view_of(s.fingerprint, self);
        d["coordinates"] = view_of(s.coordinates, self);
        d["names"] = s.names;
        d["lengths"] = view_of(s.lengths, self);
        d["complete_up_to"] = s.complete_up_to;
        d["marking_gap"] = s.marking_gap;
        d["residual_max"] = s.residual_max;
        list.append(d);
    }
    return list;
}

py::dict types(const py::object& self) {
    py::dict d;
    for (const IndexBucket& b : self.cast<const Contents&>().types)
        d[py::str(type_name(b.genus, b.boundaries))] = b.files.size();
    return d;
}

py::list failures(const Contents& c) {
    py::list list;
    for (const FailureRecord& f : c.index.failures)
        list.append(py::make_tuple(f.item, f.stage, f.status, f.message));
    return list;
}

/// (names, distances (N,N), merges [(first, second, height, members)], leaf order, clusters)
py::tuple distances(const std::string& path, Index genus, Index boundaries, const std::string& metric,
                    const std::string& linkage, std::size_t clusters, int threads) {
    const ShapeMetric m = app::parse_shape_metric(metric);
    const Linkage l = app::parse_linkage(linkage);
    auto* d = new app::TypeDistances(run_long(py::none(), [&](Call&) {
        app::TypeDistances result;
        const auto bucket = IndexReader(path).bucket(genus, boundaries);
        if (!bucket) throw app::UsageError(path + ": holds no shape of type " + type_name(genus, boundaries));
        with_thread_limit(resolved(threads),
                          [&] { result = app::measure_distances(*bucket, m, l, clusters); });
        return result;
    }));
    const py::capsule owner(d, [](void* p) { delete static_cast<app::TypeDistances*>(p); });
    py::list merges;
    for (const Merge& merge : d->tree.merges)
        merges.append(py::make_tuple(merge.first, merge.second, merge.height, merge.members));
    const auto n = static_cast<py::ssize_t>(d->matrix.size);
    return py::make_tuple(d->names, view_of(d->matrix.values.data(), {n, n}, {}, owner), merges, d->order,
                          d->clusters);
}

}  // namespace

void add_index(py::module_& m) {
    m.def("index_build", &build);
    m.def("index_add", &add);
    m.def("index_remove", &remove);
    m.def("index_contents", &contents);
    m.def("index_distances", &distances);
    py::class_<Contents, std::shared_ptr<Contents>>(m, "IndexContents")
        .def_property_readonly("entries", &entries)
        .def_property_readonly("types", &types)
        .def_property_readonly("failures", &failures)
        .def_property_readonly("config", [](const Contents& c) { return c.index.info.config; });
    py::class_<Search>(m, "IndexSearch")
        .def(py::init([](const std::string& path, const std::string& metric) {
            return run_long(py::none(), [&](Call&) { return std::make_unique<Search>(path, metric); });
        }))
        .def("ask_file",
             [](Search& s, const std::string& file, std::size_t k, bool others) {
                 return to_python(run_long(
                     py::none(), [&](Call& call) { return s.ask_file(file, k, others, call.stop()); }));
             })
        .def("ask_surface", [](Search& s, const Surface& surface, std::size_t k, bool others) {
            return to_python(run_long(
                py::none(), [&](Call& call) { return s.ask_surface(surface, k, others, call.stop()); }));
        });
}

}  // namespace ricci::python
