#include "engine/app/isolation/message.h"

#include <algorithm>
#include <utility>

#include "io/store/durable.h"

namespace ricci::app {
namespace {

constexpr std::uint32_t kMagic = 0x52494343U;

struct FrameHeader {
    std::uint32_t magic, kind;
    std::uint64_t size, checksum;  // of kind, size and the bytes
};

std::uint64_t checksum_of_frame(std::uint32_t kind, std::string_view bytes) {
    return checksum_of(bytes) ^ (static_cast<std::uint64_t>(kind) << 32U) ^ bytes.size();
}

}  // namespace

MessageWriter& MessageWriter::put(const FailureRecord& failure) {
    return put(failure.item).put(failure.stage).put(failure.status).put(failure.message);
}

MessageWriter& MessageWriter::put(const ItemRecord& item) {
    put(item.name).put(item.source).put(item.source_hash).put(item.units);
    put(item.vertices).put(item.faces).put(item.genus).put(item.boundaries).put(item.euler_characteristic);
    return put(item.points).put(item.triangles).put(item.source_vertex).put(item.twin).put(item.edge_length);
}

MessageWriter& MessageWriter::put(const SweepBlock& block) {
    put(block.item).put(static_cast<std::uint64_t>(block.rows.size()));
    for (const SweepRow& row : block.rows)
        put(row.vertex)
            .put(row.status)
            .put(row.area_distortion)
            .put(row.newton_iterations)
            .put(row.residual_max)
            .put(row.flips)
            .put(row.seconds)
            .put(row.gauss_bonnet_error)
            .put(row.precision_digits);
    put(static_cast<std::uint64_t>(block.kept.size()));
    for (const KeptFactor& kept : block.kept)
        put(kept.vertex).put(kept.area_distortion).put(kept.conformal_factor);
    return *this;
}

MessageWriter& MessageWriter::put(const ShapeRecord& shape) {
    put(shape.hash).put(shape.component).put(shape.components).put(shape.status).put(shape.message);
    put(shape.genus).put(shape.boundaries).put(shape.vertices).put(shape.faces);
    put(shape.fingerprint).put(shape.coordinates);
    put(static_cast<std::uint64_t>(shape.names.size()));
    for (const std::string& name : shape.names) put(name);
    put(shape.lengths).put(shape.primitive).put(shape.complete_up_to).put(shape.marking_gap);
    put(shape.residual_max).put(shape.gauss_bonnet_error).put(shape.precision_digits);
    put(std::span<const double>(shape.seconds)).put(static_cast<std::uint64_t>(shape.resolutions.size()));
    for (const ShapeResolution& resolution : shape.resolutions)
        put(resolution.faces).put(resolution.fingerprint).put(resolution.coordinates);
    return *this;
}

std::string_view MessageReader::take(std::uint64_t count, std::size_t size) {
    if (count > left_.size() / size) throw ProtocolError("a message ends too early");
    const std::string_view taken = left_.substr(0, static_cast<std::size_t>(count) * size);
    left_.remove_prefix(taken.size());
    return taken;
}

std::string MessageReader::get_text() {
    return std::string(take(get<std::uint64_t>(), 1));
}

FailureRecord MessageReader::get_failure() {
    FailureRecord failure;
    for (std::string* text : {&failure.item, &failure.stage, &failure.status, &failure.message})
        *text = get_text();
    return failure;
}

ItemRecord MessageReader::get_item() {
    ItemRecord item;
    for (std::string* text : {&item.name, &item.source, &item.source_hash, &item.units}) *text = get_text();
    for (Index* number :
         {&item.vertices, &item.faces, &item.genus, &item.boundaries, &item.euler_characteristic})
        *number = get<Index>();
    item.points = get_vector<Point>();
    item.triangles = get_vector<Triangle>();
    item.source_vertex = get_vector<Index>();
    item.twin = get_vector<Index>();
    item.edge_length = get_vector<double>();
    return item;
}

SweepBlock MessageReader::get_block() {
    SweepBlock block;
    block.item = get_text();
    for (auto left = get<std::uint64_t>(); left > 0; --left) {
        SweepRow row;
        row.vertex = get<Index>();
        row.status = get<std::uint8_t>();
        row.area_distortion = get<double>();
        row.newton_iterations = get<std::uint16_t>();
        row.residual_max = get<double>();
        row.flips = get<std::int32_t>();
        row.seconds = get<float>();
        row.gauss_bonnet_error = get<double>();
        row.precision_digits = get<std::int32_t>();
        block.rows.push_back(row);
    }
    for (auto left = get<std::uint64_t>(); left > 0; --left) {
        KeptFactor kept;
        kept.vertex = get<Index>();
        kept.area_distortion = get<double>();
        kept.conformal_factor = get_vector<double>();
        block.kept.push_back(std::move(kept));
    }
    return block;
}

ShapeRecord MessageReader::get_shape() {
    ShapeRecord shape;
    shape.hash = get<std::uint64_t>();
    for (std::int32_t* number : {&shape.component, &shape.components}) *number = get<std::int32_t>();
    shape.status = get<std::uint8_t>();
    shape.message = get_text();
    for (Index* number : {&shape.genus, &shape.boundaries, &shape.vertices, &shape.faces})
        *number = get<Index>();
    shape.fingerprint = get_vector<double>();
    shape.coordinates = get_vector<double>();
    for (auto left = get<std::uint64_t>(); left > 0; --left) shape.names.push_back(get_text());
    shape.lengths = get_vector<double>();
    shape.primitive = get_vector<std::uint8_t>();
    shape.complete_up_to = get<double>();
    shape.marking_gap = get<double>();
    shape.residual_max = get<double>();
    shape.gauss_bonnet_error = get<double>();
    shape.precision_digits = get<std::int32_t>();
    const auto seconds = get_vector<double>();
    if (seconds.size() != shape.seconds.size()) throw ProtocolError("a shape has other times than it should");
    std::copy(seconds.begin(), seconds.end(), shape.seconds.begin());
    for (auto left = get<std::uint64_t>(); left > 0; --left) {
        ShapeResolution resolution;
        resolution.faces = get<Index>();
        resolution.fingerprint = get_vector<double>();
        resolution.coordinates = get_vector<double>();
        shape.resolutions.push_back(std::move(resolution));
    }
    return shape;
}

void MessageReader::end() const {
    if (!left_.empty()) throw ProtocolError("a message is too long");
}

std::string framed(std::uint32_t kind, std::string_view bytes) {
    const FrameHeader header{kMagic, kind, bytes.size(), checksum_of_frame(kind, bytes)};
    std::string frame(reinterpret_cast<const char*>(&header), sizeof header);
    return frame.append(bytes);
}

std::optional<Frame> FrameAssembler::next() {
    const std::string_view left = std::string_view(buffer_).substr(start_);
    FrameHeader header{};
    if (left.size() < sizeof header) return std::nullopt;
    std::memcpy(&header, left.data(), sizeof header);
    if (header.magic != kMagic) throw ProtocolError("what it wrote is no message");
    if (header.size > left.size() - sizeof header) return std::nullopt;
    Frame frame{header.kind, std::string(left.substr(sizeof header, header.size))};
    if (checksum_of_frame(frame.kind, frame.bytes) != header.checksum)
        throw ProtocolError("a message does not match its checksum");
    start_ += sizeof header + frame.bytes.size();
    // Handed-out bytes are dropped when they are the better half.
    if (start_ > buffer_.size() / 2) {
        buffer_.erase(0, start_);
        start_ = 0;
    }
    return frame;
}

}  // namespace ricci::app
