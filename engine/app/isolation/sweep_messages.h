// What a child that sweeps one file and its parent tell each other: the calls of SweepRecords.
#pragma once

#include <cstdint>
#include <string>

#include "engine/app/isolation/child_pool.h"
#include "engine/app/sweep_records.h"

namespace ricci::app {

/// All from the child; those marked are answered.
enum class SweepMessage : std::uint32_t {
    begin = static_cast<std::uint32_t>(PoolMessage::first_own),  // stage; answered: u1, failure
    passed,                                                      // stage
    admit,          // stage, item; answered: name, finished vertices
    chosen,         // item, i4, u8, u8, u8
    opened,         // every item of the file is known
    started,        // item, vertex
    finished,       // block
    item_finished,  // item, f8
    failed          // failure
};

inline MessageWriter& put_stage(MessageWriter& message, const SweepStage& stage) {
    return message.put(stage.item).put(stage.stage).put(stage.component).put(stage.resolution);
}
inline SweepStage get_stage(MessageReader& message) {
    SweepStage stage;
    stage.item = message.get_text();
    stage.stage = message.get_text();
    stage.component = message.get<Index>();
    stage.resolution = message.get<Index>();
    return stage;
}

}  // namespace ricci::app
