// A deformation path as JSON, text, the result file and pictures keep it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/app/pictures/draw_path.h"
#include "engine/shape_space/shape_path.h"
#include "io/store/path_file.h"

namespace ricci::app {

/// A sequence with the files of its frames, in their order.
struct FollowedSequence {
    std::vector<std::string> files;
    std::vector<PathFrame> frames;
};

/// The interface's object of one frame; sequences are counted from 1, frames from 0. Numbers that are not
/// finite are null.
nlohmann::json frame_json(std::size_t sequence, std::size_t frame, const std::string& file,
                          const PathFrame& f);
/// One line of text.
std::string frame_text(std::size_t frame, const std::string& file, const PathFrame& f);

/// All sequences have the coordinates of the first frame that converged.
std::vector<PathRecord> make_path_records(const std::vector<FollowedSequence>& sequences);
std::vector<DrawnSequence> drawn_sequences(const std::vector<FollowedSequence>& sequences);

}  // namespace ricci::app
