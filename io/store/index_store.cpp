#include "io/store/index_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "io/store/schema.h"
#include "io/store/schema_index.h"
#include "io/store/segment_folder.h"
#include "io/store/verify_file.h"

namespace ricci {
namespace {

using Key = std::pair<std::uint64_t, std::int32_t>;

constexpr const char* kStage = "describe";

// A shape that did not converge, as the journal names it: "0123456789abcdef.c1/2".
std::string journal_name(const ShapeRecord& shape) {
    return fmt::format("{}.c{}/{}", hex16(shape.hash), shape.component, shape.components);
}

std::optional<ShapeRecord> failed_shape(const FailureRecord& failure, const StatusNames& status) {
    ShapeRecord shape;
    unsigned long long hash = 0;
    int end = 0;
    if (std::sscanf(failure.item.c_str(), "%16llx.c%d/%d%n", &hash, &shape.component, &shape.components,
                    &end) != 3 ||
        end != static_cast<int>(failure.item.size()))
        return std::nullopt;
    const auto name = std::find(status.names.begin(), status.names.end(), failure.status);
    if (name == status.names.end()) return std::nullopt;
    shape.hash = hash;
    shape.status = static_cast<std::uint8_t>(name - status.names.begin());
    shape.message = failure.message;
    return shape;
}

}  // namespace

struct IndexStore::Impl {
    Impl(std::string output, RunInfo run_info, std::int32_t version, bool resume);

    void take_over_output();
    void resume_journal();
    void add(ShapeRecord shape) {
        const Key key(shape.hash, shape.component);
        shapes.insert_or_assign(key, std::move(shape));
    }
    [[nodiscard]] bool converged(const ShapeRecord& shape) const {
        return schema::converged_status(info.status) == shape.status;
    }
    [[nodiscard]] JournalHeader header() const {
        return {fmt::format("index, descriptor version {}\n{}", descriptor_version,
                            hdf5::stored_text(info.fingerprint)),
                info.status.names};
    }

    const RunInfo info;
    const std::int32_t descriptor_version;
    mutable std::mutex mutex;
    SegmentFolder parts;
    std::map<Key, ShapeRecord> shapes;
};

IndexStore::Impl::Impl(std::string output, RunInfo run_info, std::int32_t version, bool resume)
    : info(std::move(run_info)), descriptor_version(version), parts(std::move(output)) {
    take_over_output();
    if (resume && parts.has_journal())
        resume_journal();
    else
        parts.start(header());
}

void IndexStore::Impl::take_over_output() {
    const std::string& output = parts.output();
    if (!std::filesystem::exists(output)) return;
    const std::vector<std::string> complaints = verify_result_file(output);
    if (!complaints.empty()) {
        parts.add_note(
            fmt::format("{}: not a sound index, so nothing of it is used: {}", output, complaints.front()));
        return;
    }
    ShapeIndex stored = read_shape_index(output);
    if (stored.info.fingerprint != hdf5::stored_text(info.fingerprint) ||
        stored.info.status.names != info.status.names || stored.descriptor_version != descriptor_version) {
        parts.add_note(output +
                       ": made with other options or by another version; all shapes are described anew");
        return;
    }
    for (IndexEntry& entry : stored.entries) add(std::move(entry.shape));
}

void IndexStore::Impl::resume_journal() {
    parts.resume(
        header(),
        [&](const std::string& path, const JournalEntry&) {
            const hdf5::Handle file = hdf5::open_input(path);
            for (IndexEntry& entry : schema::read_entries(file, info.status)) add(std::move(entry.shape));
        },
        [&](const JournalEntry& entry) {
            if (entry.kind != "failure") return;
            if (auto shape = failed_shape(entry.failure, info.status)) add(std::move(*shape));
        },
        [](const JournalEntry& entry) { return entry.item; });
}

IndexStore::IndexStore(std::string output, RunInfo info, std::int32_t descriptor_version, bool resume) {
    if (!schema::converged_status(info.status))
        throw std::invalid_argument("the status names of an index lack \"converged\"");
    impl_ = std::make_unique<Impl>(std::move(output), std::move(info), descriptor_version, resume);
}

IndexStore::~IndexStore() {
    if (impl_->parts.open() && !impl_->parts.has_work()) impl_->parts.remove();
}

std::vector<std::string> IndexStore::notes() const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->parts.notes();
}

std::int32_t IndexStore::known_components(std::uint64_t hash) const {
    const std::lock_guard guard(impl_->mutex);
    const auto first = impl_->shapes.find({hash, 0});
    if (first == impl_->shapes.end()) return 0;
    const std::int32_t components = first->second.components;
    for (std::int32_t c = 1; c < components; ++c)
        if (!impl_->shapes.contains({hash, c})) return 0;
    return components;
}

std::vector<std::int32_t> IndexStore::components_known(std::uint64_t hash) const {
    const std::lock_guard guard(impl_->mutex);
    std::vector<std::int32_t> components;
    for (auto shape = impl_->shapes.lower_bound({hash, 0});
         shape != impl_->shapes.end() && shape->first.first == hash; ++shape)
        components.push_back(shape->first.second);
    return components;
}

bool IndexStore::knows(std::uint64_t hash, std::int32_t component) const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->shapes.contains({hash, component});
}

ShapeRecord IndexStore::shape(std::uint64_t hash, std::int32_t component) const {
    const std::lock_guard guard(impl_->mutex);
    const auto found = impl_->shapes.find({hash, component});
    if (found == impl_->shapes.end())
        throw std::invalid_argument(fmt::format("no shape {}.c{}", hex16(hash), component));
    return found->second;
}

void IndexStore::write_shapes(const std::vector<ShapeRecord>& shapes) {
    const std::lock_guard guard(impl_->mutex);
    std::vector<IndexEntry> block;
    std::set<Key> keys;
    for (const ShapeRecord& shape : shapes) {
        const Key key(shape.hash, shape.component);
        if (impl_->shapes.contains(key) || !keys.insert(key).second)
            throw std::invalid_argument("shape " + journal_name(shape) + " is stored already");
        if (impl_->converged(shape)) block.push_back({journal_name(shape), shape});
    }
    const StatusNames& status = impl_->info.status;
    schema::require_valid(block, status);
    for (const ShapeRecord& shape : shapes) {
        if (impl_->converged(shape)) continue;
        impl_->parts.append(
            {"failure",
             "",
             "",
             {},
             0,
             {journal_name(shape), kStage, status.names.at(shape.status), hdf5::stored_text(shape.message)}});
        impl_->add(shape);
    }
    if (block.empty()) return;
    std::vector<IndexEntry> stored;
    impl_->parts.write_segment(
        {"shapes", "", fmt::format("{} shapes", block.size()), {}, 0, {}},
        [&](hid_t root) { schema::write_entries(root, block, status); },
        [&](const std::string& temporary, const std::string&) {
            stored = schema::read_entries(hdf5::open_input(temporary), status);
        });
    for (IndexEntry& entry : stored) impl_->add(std::move(entry.shape));
}

void IndexStore::assemble(const std::vector<IndexSource>& sources,
                          const std::vector<FailureRecord>& failures) {
    const std::lock_guard guard(impl_->mutex);
    if (!impl_->parts.open()) throw std::logic_error("the index is assembled already");
    const StatusNames& status = impl_->info.status;
    std::vector<IndexEntry> entries;
    std::vector<FailureRecord> all = failures;
    for (const IndexSource& source : sources) {
        const auto found = impl_->shapes.find({source.hash, source.component});
        if (found == impl_->shapes.end())
            throw std::invalid_argument("index entry " + source.file + " is not described");
        const ShapeRecord& shape = found->second;
        if (impl_->converged(shape))
            entries.push_back({source.file, shape});
        else
            all.push_back({shape_name(source.file, shape.component, shape.components), kStage,
                           status.names.at(shape.status), shape.message});
    }
    schema::require_valid(entries, status);
    impl_->parts.replace_output([&](const std::string& temporary) {
        hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
            schema::write_index_info(file.root(), impl_->info, impl_->descriptor_version, schema::now());
            schema::write_entries(file.root(), entries, status);
            schema::write_failures(file.root(), all);
            file.flush();
            hdf5::write_attribute<std::int32_t>(file.root(), "complete", 1);
        });
    });
    impl_->parts.remove();
}

}  // namespace ricci
