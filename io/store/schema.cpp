#include "io/store/schema.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <span>

namespace ricci::schema {
namespace {

using hdf5::Handle;
using hdf5::Shape;

template <class T>
std::span<const typename T::value_type> flat(const std::vector<T>& rows) {
    return {rows.empty() ? nullptr : rows.front().data(), rows.size() * std::tuple_size_v<T>};
}

template <class T>
void write_rows_of(hid_t group, const char* name, const std::vector<T>& rows) {
    hdf5::write_array(group, name, flat(rows), {rows.size(), std::tuple_size_v<T>});
}

// A matrix with as many columns as T has entries; any number of rows unless `rows` says.
template <class T>
std::vector<T> read_rows_of(hid_t group, const char* name, std::optional<std::size_t> rows) {
    using Value = typename T::value_type;
    const hdf5::Input input(group, name);
    input.expect_type(hdf5::stored_type<Value>());
    const std::size_t found = input.shape().empty() ? 0 : input.shape()[0];
    input.expect_shape({rows.value_or(found), std::tuple_size_v<T>});
    std::vector<T> values(found);
    input.read_into(hdf5::stored_type<Value>(), values.empty() ? nullptr : values.front().data());
    return values;
}

template <class Value>
std::vector<Value> column(const std::vector<SweepRow>& rows, Value SweepRow::*member) {
    std::vector<Value> values;
    values.reserve(rows.size());
    for (const SweepRow& row : rows) values.push_back(row.*member);
    return values;
}

template <class Value>
void read_column(hid_t sweep, const char* name, std::vector<SweepRow>& rows, Value SweepRow::*member) {
    const std::vector<Value> values = hdf5::read_array<Value>(sweep, name, Shape{rows.size()});
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*member = values[i];
}

Handle failure_type() {
    const Handle text = hdf5::text_type();
    Handle type(H5Tcreate(H5T_COMPOUND, 4 * sizeof(char*)), "failures");
    std::size_t offset = 0;
    for (const char* name : {"item", "stage", "status", "message"}) {
        hdf5::check(H5Tinsert(type, name, offset, text), "failures");
        offset += sizeof(char*);
    }
    return type;
}

}  // namespace

Handle status_type(const StatusNames& status) {
    Handle type(H5Tenum_create(H5T_STD_U8LE), "status type");
    for (std::size_t value = 0; value < status.names.size(); ++value) {
        const auto stored = static_cast<std::uint8_t>(value);
        hdf5::check(H5Tenum_insert(type, status.names[value].c_str(), &stored),
                    "status name " + status.names[value]);
    }
    return type;
}

std::string now() {
    const auto seconds = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)));
}

void write_run_info(hid_t root, const RunInfo& info, const std::string& created) {
    hdf5::write_text_attribute(root, "format", "ricci");
    hdf5::write_attribute<std::int32_t>(root, "format_version", kFormatVersion);
    hdf5::write_text_attribute(root, "software", "ricci");
    hdf5::write_text_attribute(root, "software_version", info.software_version);
    hdf5::write_text_attribute(root, "git", info.git);
    hdf5::write_text_attribute(root, "command", info.command);
    hdf5::write_text_attribute(root, "config", info.config);
    hdf5::write_text_attribute(root, "host", info.host);
    hdf5::write_attribute<std::int32_t>(root, "threads", info.threads);
    hdf5::write_text_attribute(root, "created", created);
    hdf5::write_text_attribute(root, "fingerprint", info.fingerprint);
    hdf5::write_texts_attribute(root, "status_names", info.status.names);
    hdf5::seal(root);
}

RunInfo read_run_info(hid_t root) {
    if (hdf5::read_text_attribute(root, "format") != "ricci" ||
        hdf5::read_text_attribute(root, "software") != "ricci")
        throw FileError("attribute format is not \"ricci\"");
    const auto version = hdf5::read_attribute<std::int32_t>(root, "format_version");
    if (version != kFormatVersion) throw FileError(fmt::format("format_version {} is unknown", version));
    RunInfo info;
    info.software_version = hdf5::read_text_attribute(root, "software_version");
    info.git = hdf5::read_text_attribute(root, "git");
    info.command = hdf5::read_text_attribute(root, "command");
    info.config = hdf5::read_text_attribute(root, "config");
    info.host = hdf5::read_text_attribute(root, "host");
    info.threads = hdf5::read_attribute<std::int32_t>(root, "threads");
    info.created = hdf5::read_text_attribute(root, "created");
    info.fingerprint = hdf5::read_text_attribute(root, "fingerprint");
    info.status.names = hdf5::read_texts_attribute(root, "status_names");
    return info;
}

void write_item(hid_t group, const ItemRecord& item) {
    hdf5::write_text_attribute(group, "source", item.source);
    hdf5::write_text_attribute(group, "source_hash", item.source_hash);
    hdf5::write_text_attribute(group, "units", item.units);
    hdf5::write_attribute<std::int32_t>(group, "vertices", item.vertices);
    hdf5::write_attribute<std::int32_t>(group, "faces", item.faces);
    hdf5::write_attribute<std::int32_t>(group, "genus", item.genus);
    hdf5::write_attribute<std::int32_t>(group, "boundaries", item.boundaries);
    hdf5::write_attribute<std::int32_t>(group, "euler_characteristic", item.euler_characteristic);
    hdf5::seal(group);
    const Handle mesh = hdf5::create_group(group, "mesh");
    if (!item.points.empty()) write_rows_of(mesh, "points", item.points);
    write_rows_of(mesh, "triangles", item.triangles);
    if (!item.source_vertex.empty()) hdf5::write_array(mesh, "source_vertex", item.source_vertex);
    if (!item.twin.empty()) hdf5::write_array(mesh, "twin", item.twin);
    if (!item.edge_length.empty()) hdf5::write_array(mesh, "edge_length", item.edge_length);
}

ItemRecord read_item(hid_t group, const std::string& name) {
    ItemRecord item;
    item.name = name;
    item.source = hdf5::read_text_attribute(group, "source");
    item.source_hash = hdf5::read_text_attribute(group, "source_hash");
    item.units = hdf5::read_text_attribute(group, "units");
    item.vertices = hdf5::read_attribute<std::int32_t>(group, "vertices");
    item.faces = hdf5::read_attribute<std::int32_t>(group, "faces");
    item.genus = hdf5::read_attribute<std::int32_t>(group, "genus");
    item.boundaries = hdf5::read_attribute<std::int32_t>(group, "boundaries");
    item.euler_characteristic = hdf5::read_attribute<std::int32_t>(group, "euler_characteristic");
    const Handle mesh = hdf5::open_group(group, "mesh");
    if (hdf5::has_link(mesh, "points")) item.points = read_rows_of<Point>(mesh, "points", std::nullopt);
    item.triangles = read_rows_of<Triangle>(mesh, "triangles", std::nullopt);
    const auto any = std::optional<Shape>();
    if (hdf5::has_link(mesh, "source_vertex"))
        item.source_vertex = hdf5::read_array<Index>(mesh, "source_vertex", any);
    if (hdf5::has_link(mesh, "twin")) item.twin = hdf5::read_array<Index>(mesh, "twin", any);
    if (hdf5::has_link(mesh, "edge_length"))
        item.edge_length = hdf5::read_array<double>(mesh, "edge_length", any);
    try {
        require_valid(item);
    } catch (const std::invalid_argument& error) {
        throw FileError(error.what());
    }
    return item;
}

void write_rows(hid_t sweep, const std::vector<SweepRow>& rows, const StatusNames& status) {
    const std::vector<std::uint8_t> states = column(rows, &SweepRow::status);
    hdf5::write_array(sweep, "vertex", column(rows, &SweepRow::vertex));
    hdf5::write_values(sweep, "status", status_type(status), {rows.size()},
                       std::as_bytes(std::span<const std::uint8_t>(states)));
    hdf5::write_array(sweep, "area_distortion", column(rows, &SweepRow::area_distortion));
    hdf5::write_array(sweep, "newton_iterations", column(rows, &SweepRow::newton_iterations));
    hdf5::write_array(sweep, "residual_max", column(rows, &SweepRow::residual_max));
    hdf5::write_array(sweep, "flips", column(rows, &SweepRow::flips));
    hdf5::write_array(sweep, "seconds", column(rows, &SweepRow::seconds));
    hdf5::write_array(sweep, "gauss_bonnet_error", column(rows, &SweepRow::gauss_bonnet_error));
    hdf5::write_array(sweep, "precision_digits", column(rows, &SweepRow::precision_digits));
}

std::vector<SweepRow> read_rows(hid_t sweep, const StatusNames& status) {
    const hdf5::Input states(sweep, "status");
    const Handle type = status_type(status);
    states.expect_type(type);  // the enum's names are those of the root
    states.expect_shape({states.size()});
    std::vector<SweepRow> rows(states.size());
    std::vector<std::uint8_t> values(rows.size());
    states.read_into(type, values.data());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (values[i] >= status.names.size())
            throw FileError(fmt::format("{}: value {} has no name", states.name(), values[i]));
        rows[i].status = values[i];
    }
    read_column(sweep, "vertex", rows, &SweepRow::vertex);
    read_column(sweep, "area_distortion", rows, &SweepRow::area_distortion);
    read_column(sweep, "newton_iterations", rows, &SweepRow::newton_iterations);
    read_column(sweep, "residual_max", rows, &SweepRow::residual_max);
    read_column(sweep, "flips", rows, &SweepRow::flips);
    read_column(sweep, "seconds", rows, &SweepRow::seconds);
    if (hdf5::has_link(sweep, "precision_digits")) {
        read_column(sweep, "gauss_bonnet_error", rows, &SweepRow::gauss_bonnet_error);
        read_column(sweep, "precision_digits", rows, &SweepRow::precision_digits);
    } else {
        for (SweepRow& row : rows) {
            row.gauss_bonnet_error = std::numeric_limits<double>::quiet_NaN();
            row.precision_digits = 0;
        }
    }
    return rows;
}

void write_extreme(hid_t sweep, const char* name, const KeptFactor& factor) {
    const Handle group = hdf5::create_group(sweep, name);
    hdf5::write_scalar<Index>(group, "vertex", factor.vertex);
    hdf5::write_scalar<double>(group, "area_distortion", factor.area_distortion);
    hdf5::write_array(group, "conformal_factor", factor.conformal_factor);
}

std::vector<Index> read_kept_vertices(hid_t sweep, std::size_t vertex_count) {
    if (!hdf5::has_link(sweep, "kept")) return {};
    const Handle group = hdf5::open_group(sweep, "kept");
    std::vector<Index> vertices = hdf5::read_array<Index>(group, "vertex", std::nullopt);
    const hdf5::Input factors(group, "conformal_factor");
    factors.expect_type(hdf5::stored_type<double>());
    factors.expect_shape({vertices.size(), vertex_count});
    return vertices;
}

std::optional<Index> read_extreme_vertex(hid_t sweep, const char* name) {
    if (!hdf5::has_link(sweep, name)) return std::nullopt;
    return hdf5::read_scalar<Index>(hdf5::open_group(sweep, name), "vertex");
}

KeptFactor read_extreme(hid_t sweep, const char* name, std::size_t vertex_count) {
    const Handle group = hdf5::open_group(sweep, name);
    KeptFactor factor;
    factor.vertex = hdf5::read_scalar<Index>(group, "vertex");
    factor.area_distortion = hdf5::read_scalar<double>(group, "area_distortion");
    factor.conformal_factor = hdf5::read_array<double>(group, "conformal_factor", Shape{vertex_count});
    return factor;
}

void write_status(hid_t group, std::uint8_t value, const StatusNames& status) {
    const Handle type = status_type(status);
    const std::string what = hdf5::name_of(group) + ": attribute status";
    const Handle space(H5Screate(H5S_SCALAR), what);
    const Handle attribute(H5Acreate2(group, "status", type, space, H5P_DEFAULT, H5P_DEFAULT), what);
    hdf5::check(H5Awrite(attribute, type, &value), what);
}

std::uint8_t read_status(hid_t group, const StatusNames& status) {
    const std::string where = hdf5::name_of(group) + ": attribute status";
    const Handle attribute(H5Aopen(group, "status", H5P_DEFAULT), where + " is missing");
    const Handle type = status_type(status);
    const Handle stored(H5Aget_type(attribute), where);
    if (H5Tequal(stored, type) <= 0) throw FileError(where + " has other names than status_names");
    const Handle space(H5Aget_space(attribute), where);
    if (H5Sget_simple_extent_npoints(space) != 1) throw FileError(where + " is not one value");
    std::uint8_t value = 0;
    hdf5::check(H5Aread(attribute, type, &value), where);
    return value;
}

void write_flow(hid_t group, const FlowRecord& flow, const StatusNames& status) {
    hdf5::write_text_attribute(group, "geometry", flow.geometry);
    hdf5::write_text_attribute(group, "scheme", flow.scheme);
    hdf5::write_text_attribute(group, "method", flow.method);
    hdf5::write_text_attribute(group, "boundary", flow.boundary);
    write_status(group, flow.status, status);
    hdf5::write_attribute<std::int32_t>(group, "newton_iterations", flow.newton_iterations);
    hdf5::write_attribute<std::int32_t>(group, "flips", flow.flips);
    hdf5::write_attribute<double>(group, "residual_max", flow.residual_max);
    hdf5::write_attribute<double>(group, "gauss_bonnet_error", flow.gauss_bonnet_error);
    hdf5::write_attribute<double>(group, "seconds", flow.seconds);
    hdf5::write_attribute<std::int32_t>(group, "precision_digits", flow.precision_digits);
    hdf5::write_attribute<std::uint8_t>(group, "doubled", static_cast<std::uint8_t>(flow.doubled));
    hdf5::seal(group);
    hdf5::write_array(group, "conformal_factor", flow.conformal_factor);
    if (!flow.conformal_factor_low.empty())
        hdf5::write_array(group, "conformal_factor_low", flow.conformal_factor_low);
    hdf5::write_array(group, "target_curvature", flow.target_curvature);
    hdf5::write_array(group, "curvature", flow.curvature);
    write_rows_of(group, "triangles", flow.triangles);
    hdf5::write_array(group, "twin", flow.twin);
    hdf5::write_array(group, "edge_length", flow.edge_length);
    const Handle log = hdf5::create_group(group, "log");
    hdf5::write_array(log, "residual_max", flow.log_residual_max);
    hdf5::write_array(log, "step", flow.log_step);
    hdf5::write_array(log, "flips", flow.log_flips);
    hdf5::write_array(log, "seconds", flow.log_seconds);
}

FlowRecord read_flow(hid_t group, const std::string& item, std::size_t vertex_count,
                     const StatusNames& status) {
    FlowRecord flow;
    flow.item = item;
    flow.geometry = hdf5::read_text_attribute(group, "geometry");
    flow.scheme = hdf5::read_text_attribute(group, "scheme");
    flow.method = hdf5::read_text_attribute(group, "method");
    flow.boundary = hdf5::read_text_attribute(group, "boundary");
    flow.status = read_status(group, status);
    flow.newton_iterations = hdf5::read_attribute<std::int32_t>(group, "newton_iterations");
    flow.flips = hdf5::read_attribute<std::int32_t>(group, "flips");
    flow.residual_max = hdf5::read_attribute<double>(group, "residual_max");
    flow.gauss_bonnet_error = hdf5::read_attribute<double>(group, "gauss_bonnet_error");
    flow.seconds = hdf5::read_attribute<double>(group, "seconds");
    flow.doubled = hdf5::read_attribute<std::uint8_t>(group, "doubled") != 0;
    flow.precision_digits = hdf5::has_attribute(group, "precision_digits")
                                ? hdf5::read_attribute<std::int32_t>(group, "precision_digits")
                                : 0;
    const Shape per_vertex{vertex_count};
    flow.conformal_factor = hdf5::read_array<double>(group, "conformal_factor", per_vertex);
    if (hdf5::has_link(group, "conformal_factor_low"))
        flow.conformal_factor_low = hdf5::read_array<double>(group, "conformal_factor_low", per_vertex);
    flow.target_curvature = hdf5::read_array<double>(group, "target_curvature", per_vertex);
    flow.curvature = hdf5::read_array<double>(group, "curvature", per_vertex);
    flow.triangles = read_rows_of<Triangle>(group, "triangles", std::nullopt);
    const Shape per_halfedge{3 * flow.triangles.size()};
    flow.twin = hdf5::read_array<Index>(group, "twin", per_halfedge);
    flow.edge_length = hdf5::read_array<double>(group, "edge_length", per_halfedge);
    const Handle log = hdf5::open_group(group, "log");
    flow.log_residual_max = hdf5::read_array<double>(log, "residual_max", std::nullopt);
    const Shape per_step{flow.log_residual_max.size()};
    flow.log_step = hdf5::read_array<double>(log, "step", per_step);
    flow.log_flips = hdf5::read_array<std::int32_t>(log, "flips", per_step);
    flow.log_seconds = hdf5::read_array<double>(log, "seconds", per_step);
    try {
        require_valid(flow, vertex_count, status);
    } catch (const std::invalid_argument& error) {
        throw FileError(error.what());
    }
    return flow;
}

void write_failures(hid_t root, const std::vector<FailureRecord>& failures) {
    std::vector<std::string> texts;
    for (const FailureRecord& failure : failures)
        for (const std::string* text : {&failure.item, &failure.stage, &failure.status, &failure.message})
            texts.push_back(hdf5::stored_text(*text));
    std::vector<const char*> pointers;
    pointers.reserve(texts.size());
    for (const std::string& text : texts) pointers.push_back(text.c_str());
    const Handle type = failure_type();
    hdf5::write_texts(root, "failures", type, {failures.size()}, pointers);
}

std::vector<FailureRecord> read_failures(hid_t root) {
    const hdf5::Input input(root, "failures");
    const Handle type = failure_type();
    input.expect_type(type);
    input.expect_shape({input.size()});
    const std::vector<std::string> texts = hdf5::read_texts(input, type, 4);
    std::vector<FailureRecord> failures;
    for (std::size_t i = 0; i < texts.size(); i += 4)
        failures.push_back({texts[i], texts[i + 1], texts[i + 2], texts[i + 3]});
    return failures;
}

}  // namespace ricci::schema
