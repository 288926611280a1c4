// What a parent believes of a child: whole frames with a right checksum, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/app/isolation/message.h"
#include "tests/support/random.h"

namespace ricci::app {
namespace {

using ricci::testing::Random;

ItemRecord sample_item() {
    ItemRecord item;
    item.name = "a@4";
    item.source = "folder/a \xC3\xA9.off";
    item.source_hash = "0123456789abcdef";
    item.vertices = 4;
    item.faces = 4;
    item.euler_characteristic = 2;
    item.points = {{0, 0, 0}, {1, 0, -0.0}, {0, 1e-300, 0}, {0, 0, 1}};
    item.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    item.source_vertex = {3, 2, 1, 0};
    item.edge_length = {1.0, 2.0};
    return item;
}

SweepBlock sample_block() {
    SweepBlock block;
    block.item = "a@4";
    block.rows = {{7, 0, 0.25, 12, 1e-11, 40, 0.5F},
                  {9, 5, std::numeric_limits<double>::quiet_NaN(), 3, 0.1, 0, 0.25F}};
    block.kept = {{7, 0.25, {1.0, -2.0, 0x1.123456789abcdp-40}}};
    return block;
}

TEST(IsolationMessage, RecordsComeOutAsTheyWentIn) {
    MessageWriter writer;
    writer.put(sample_item()).put(sample_block()).put(FailureRecord{"a", "load", "timeout", ""}).put(true);
    MessageReader reader(writer.bytes());
    const ItemRecord item = reader.get_item();
    const SweepBlock block = reader.get_block();
    const FailureRecord failure = reader.get_failure();
    EXPECT_TRUE(reader.get<bool>());
    reader.end();
    // The same records give the same bytes, so equal bytes are equal records.
    MessageWriter again;
    again.put(item).put(block).put(failure).put(true);
    EXPECT_EQ(again.bytes(), writer.bytes());
    EXPECT_EQ(item.points, sample_item().points);
    EXPECT_TRUE(std::signbit(item.points[1][2]));
    EXPECT_EQ(block.kept[0].conformal_factor, sample_block().kept[0].conformal_factor);
    EXPECT_TRUE(std::isnan(block.rows[1].area_distortion));
    EXPECT_EQ(failure.stage, "load");
}

TEST(IsolationMessage, EndsTooEarlyAtEveryByte) {
    MessageWriter writer;
    writer.put(sample_item()).put(sample_block());
    for (std::size_t size = 0; size < writer.bytes().size(); ++size) {
        MessageReader reader(std::string_view(writer.bytes()).substr(0, size));
        EXPECT_THROW(
            {
                reader.get_item();
                reader.get_block();
            },
            ProtocolError)
            << size;
    }
}

TEST(IsolationMessage, FramesComeTogetherFromAnyPieces) {
    Random random(11);
    std::string stream;
    std::vector<Frame> sent;
    for (std::uint32_t k = 0; k < 50; ++k) {
        sent.push_back({k, std::string(random.below<std::size_t>(200), static_cast<char>('a' + k % 26))});
        stream += framed(sent.back().kind, sent.back().bytes);
    }
    FrameAssembler assembler;
    std::vector<Frame> received;
    for (std::string_view left = stream; !left.empty();) {
        const std::size_t piece = std::min(left.size(), 1 + random.below<std::size_t>(90));
        assembler.add(left.substr(0, piece));
        left.remove_prefix(piece);
        while (auto frame = assembler.next()) received.push_back(*frame);
    }
    ASSERT_EQ(received.size(), sent.size());
    for (std::size_t k = 0; k < sent.size(); ++k) {
        EXPECT_EQ(received[k].kind, sent[k].kind);
        EXPECT_EQ(received[k].bytes, sent[k].bytes);
    }
}

TEST(IsolationMessage, NoFlippedBitIsBelieved) {
    const std::string bytes = MessageWriter().put(sample_block()).bytes();
    const std::string whole = framed(12, bytes);
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        FrameAssembler assembler;
        assembler.add(damaged);
        try {
            EXPECT_FALSE(assembler.next().has_value()) << "bit " << bit;
        } catch (const ProtocolError&) {
        }
    }
}

}  // namespace
}  // namespace ricci::app
