#include "io/store/export_fields.h"

#include <set>
#include <stdexcept>

#include "io/store/schema.h"

namespace ricci {

void require_exportable(const ItemRecord& item, const std::vector<PointField>& fields) {
    schema::require_valid(item);
    if (item.points.empty())
        throw std::invalid_argument("item " + item.name + " is intrinsic: it has no points to show");
    std::set<std::string> names;
    for (const PointField& field : fields) {
        if (field.values.size() != item.points.size())
            throw std::invalid_argument("field " + field.name + " has not one value per vertex");
        if (field.name.empty() || field.name.find('/') != std::string::npos ||
            !names.insert(field.name).second)
            throw std::invalid_argument("field name \"" + field.name +
                                        "\" is empty, doubled or holds a slash");
    }
}

}  // namespace ricci
