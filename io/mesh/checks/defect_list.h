// Collects defects in the order found, lists the first few of each code, and counts the rest.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace ricci {

class DefectList {
  public:
    /// So many defects of a code are listed one by one; a summary entry says how many more there are.
    static constexpr std::int64_t kListed = 20;

    /// Records a defect. `message` is a string or makes one; it is not called for those that are only
    /// counted.
    template <class Message>
    void add(std::string_view code, std::string_view element, std::int64_t index, const Message& message) {
        Group& group = group_of(code);
        if (++group.count > kListed) return;
        if constexpr (std::invocable<const Message&>) {
            group.listed.push_back({std::string(code), std::string(element), index, message()});
        } else {
            group.listed.push_back({std::string(code), std::string(element), index, std::string(message)});
        }
    }

    [[nodiscard]] bool empty() const { return groups_.empty(); }

    /// How many defects of this code were added.
    [[nodiscard]] std::int64_t count(std::string_view code) const;

    /// All listed defects, codes in order of first occurrence, each with its summary entry where cut short
    /// (index -1, message "and N more ...").
    [[nodiscard]] std::vector<Defect> defects() const;

  private:
    struct Group {
        std::string code;
        std::int64_t count = 0;
        std::vector<Defect> listed;
    };
    Group& group_of(std::string_view code);

    std::vector<Group> groups_;  // a handful: linear search
};

}  // namespace ricci
