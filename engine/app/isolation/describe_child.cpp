// A child that reads and describes one file for an index.
#include <unistd.h>

#include <algorithm>

#include "engine/app/isolation/child_main.h"
#include "engine/app/isolation/isolated_index.h"
#include "engine/app/shape_record.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/sweep_config.h"
#include "io/mesh/mesh_file.h"
#include "io/store/durable.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

void send(ParentChannel& parent, DescribeMessage kind, const MessageWriter& message) {
    parent.send(static_cast<std::uint32_t>(kind), message.bytes());
}

std::function<std::optional<Status>()> interruption_with_pulse(ParentChannel& parent, double timeout) {
    return [&parent, asked = interruption(timeout)] {
        parent.pulse();
        return asked();
    };
}

ShapeRecord describe(ParentChannel& parent, const ChildShare& share, const SurfaceMesh& mesh,
                     const IndexConfig& config) {
    ShapeOptions options = shape_options(config);
    options.flow.parallel = share.threads > 1;
    options.flow.interrupted = interruption_with_pulse(parent, config.timeout);
    ShapeRecord record = describe_to_record(mesh, options, parse_resolutions(config.resolutions));
    if (caught_signal() != 0) ::_exit(128 + caught_signal());
    const bool starved = record.status == static_cast<std::uint8_t>(Status::out_of_memory);
    if (starved && share.memory > 0 && !share.whole) end_out_of_memory();
    return record;
}

}  // namespace

void describe_in_child(ParentChannel& parent, const ChildShare& share, MessageReader& job) {
    const std::string file = job.get_text();
    const IndexConfig config = index_config_from_toml(job.get_text());
    const auto skip = job.get_vector<std::int32_t>();
    job.end();
    fault_point("load", file);
    LoadedMesh loaded;
    std::uint64_t hash = 0;
    try {
        std::string bytes = read_text(file);
        hash = checksum_of(std::string_view(bytes));
        loaded = load_mesh_bytes(file, std::move(bytes), parse_repair(config.repair));
    } catch (const FileError& e) {
        return send(parent, DescribeMessage::load_error, MessageWriter().put(e.what()));
    }
    if (!loaded.report.errors.empty())
        return send(parent, DescribeMessage::load_error, MessageWriter().put(joined_errors(loaded)));
    const auto components = static_cast<std::int32_t>(loaded.components.size());
    for (std::int32_t c = 0; c < components; ++c) {
        if (std::find(skip.begin(), skip.end(), c) != skip.end()) continue;
        send(parent, DescribeMessage::component, MessageWriter().put(c).put(components));
        fault_point("describe", shape_name(file, c, components));
        ShapeRecord record;
        with_thread_limit(share.threads, [&] {
            record = describe(parent, share, loaded.components[static_cast<std::size_t>(c)], config);
        });
        record.hash = hash;
        record.component = c;
        record.components = components;
        send(parent, DescribeMessage::shape, MessageWriter().put(record));
    }
}

}  // namespace ricci::app
