#include "io/store/schema_shard.h"

#include <fmt/format.h>

#include <span>

#include "io/store/durable.h"

namespace ricci {

std::string shard_name(std::int32_t index, std::int32_t count) {
    return fmt::format("{}/{}", index, count);
}

std::uint64_t digest_of_vertices(const std::vector<Index>& vertices) {
    return checksum_of(std::as_bytes(std::span<const Index>(vertices)));
}

namespace schema {
namespace {

template <class Value>
void write_column(hid_t group, const char* name, const std::vector<ShardItem>& items,
                  Value ShardItem::*member) {
    std::vector<Value> values;
    values.reserve(items.size());
    for (const ShardItem& item : items) values.push_back(item.*member);
    if constexpr (std::is_same_v<Value, std::string>)
        hdf5::write_text_list(group, name, values);
    else
        hdf5::write_array(group, name, values);
}

template <class Value>
void read_column(hid_t group, const char* name, std::vector<ShardItem>& items, Value ShardItem::*member) {
    const std::vector<Value> values = hdf5::read_array<Value>(group, name, hdf5::Shape{items.size()});
    for (std::size_t i = 0; i < items.size(); ++i) items[i].*member = values[i];
}

std::vector<std::string> read_text_column(hid_t group, const char* name) {
    const hdf5::Input input(group, name);
    const hdf5::Handle type = hdf5::text_type();
    input.expect_type(type);
    input.expect_shape({input.size()});
    return hdf5::read_texts(input, type, 1);
}

std::vector<ShardItem> read_items(hid_t group) {
    const std::vector<std::string> names = read_text_column(group, "item"),
                                   bases = read_text_column(group, "base");
    if (bases.size() != names.size()) throw FileError("/shard/base has not one value per item");
    std::vector<ShardItem> items(names.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        items[i].name = names[i];
        items[i].base = bases[i];
    }
    read_column(group, "input", items, &ShardItem::input);
    read_column(group, "component", items, &ShardItem::component);
    read_column(group, "resolution", items, &ShardItem::resolution);
    read_column(group, "chosen", items, &ShardItem::chosen);
    read_column(group, "own", items, &ShardItem::own);
    read_column(group, "chosen_xxh3", items, &ShardItem::chosen_xxh3);
    read_column(group, "stored", items, &ShardItem::stored);
    return items;
}

}  // namespace

void write_shard(hid_t root, const ShardTable& table) {
    const hdf5::Handle group = hdf5::create_group(root, "shard");
    hdf5::write_attribute<std::int32_t>(group, "index", table.index);
    hdf5::write_attribute<std::int32_t>(group, "count", table.count);
    hdf5::write_attribute<std::int32_t>(group, "inputs", table.inputs);
    hdf5::write_attribute<std::int32_t>(group, "resolutions", table.resolutions);
    hdf5::write_text_attribute(group, "plan", table.plan);
    hdf5::write_text_attribute(group, "config", table.config);
    hdf5::write_text_attribute(group, "fingerprint", table.fingerprint);
    hdf5::write_text_attribute(group, "processors", table.processors);
    hdf5::write_attribute<std::uint8_t>(group, "keep_best", static_cast<std::uint8_t>(table.keep.best));
    hdf5::write_attribute<std::uint8_t>(group, "keep_worst", static_cast<std::uint8_t>(table.keep.worst));
    hdf5::write_attribute<std::int64_t>(group, "keep_count", table.keep.count);
    hdf5::seal(group);
    write_column(group, "item", table.items, &ShardItem::name);
    write_column(group, "base", table.items, &ShardItem::base);
    write_column(group, "input", table.items, &ShardItem::input);
    write_column(group, "component", table.items, &ShardItem::component);
    write_column(group, "resolution", table.items, &ShardItem::resolution);
    write_column(group, "chosen", table.items, &ShardItem::chosen);
    write_column(group, "own", table.items, &ShardItem::own);
    write_column(group, "chosen_xxh3", table.items, &ShardItem::chosen_xxh3);
    write_column(group, "stored", table.items, &ShardItem::stored);
}

std::optional<ShardTable> read_shard(hid_t root) {
    if (!hdf5::has_link(root, "shard")) return std::nullopt;
    const hdf5::Handle group = hdf5::open_group(root, "shard");
    ShardTable table;
    table.index = hdf5::read_attribute<std::int32_t>(group, "index");
    table.count = hdf5::read_attribute<std::int32_t>(group, "count");
    table.inputs = hdf5::read_attribute<std::int32_t>(group, "inputs");
    table.resolutions = hdf5::read_attribute<std::int32_t>(group, "resolutions");
    if (table.index < 0 || table.index >= table.count)
        throw FileError(fmt::format("/shard: there is no shard {}", shard_name(table.index, table.count)));
    if (table.inputs < 0 || table.resolutions < 1)
        throw FileError(fmt::format("/shard: {} inputs at {} resolutions", table.inputs, table.resolutions));
    table.plan = hdf5::read_text_attribute(group, "plan");
    table.config = hdf5::read_text_attribute(group, "config");
    table.fingerprint = hdf5::read_text_attribute(group, "fingerprint");
    table.processors = hdf5::read_text_attribute(group, "processors");
    table.keep.best = hdf5::read_attribute<std::uint8_t>(group, "keep_best") != 0;
    table.keep.worst = hdf5::read_attribute<std::uint8_t>(group, "keep_worst") != 0;
    table.keep.count = hdf5::read_attribute<std::int64_t>(group, "keep_count");
    table.items = read_items(group);
    return table;
}

}  // namespace schema
}  // namespace ricci
