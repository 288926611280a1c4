#include "io/mesh/checks/defect_list.h"

namespace ricci {

std::int64_t DefectList::count(std::string_view code) const {
    for (const Group& group : groups_) {
        if (group.code == code) return group.count;
    }
    return 0;
}

DefectList::Group& DefectList::group_of(std::string_view code) {
    for (Group& group : groups_) {
        if (group.code == code) return group;
    }
    groups_.push_back({std::string(code), 0, {}});
    return groups_.back();
}

std::vector<Defect> DefectList::defects() const {
    std::vector<Defect> all;
    for (const Group& group : groups_) {
        all.insert(all.end(), group.listed.begin(), group.listed.end());
        const std::int64_t more = group.count - kListed;
        if (more > 0) {
            all.push_back({group.code, group.listed.front().element, -1,
                           "and " + std::to_string(more) + " more " + group.code + " (" +
                               std::to_string(group.count) + " in all)"});
        }
    }
    return all;
}

}  // namespace ricci
