#include "engine/app/accuracy_record.h"

#include "engine/app/console.h"

namespace ricci::app {

void add_accuracy(const MetricAccuracy& accuracy, nlohmann::json& object) {
    object["residual_max"] = finite_or_null(accuracy.residual_max);
    object["gauss_bonnet_error"] = finite_or_null(accuracy.gauss_bonnet_error);
    object["precision_digits"] = accuracy.precision_digits;
}

void add_accuracy(const MetricAccuracy& accuracy, ResultGroup& group) {
    group.attributes.push_back({"residual_max", accuracy.residual_max});
    group.attributes.push_back({"gauss_bonnet_error", accuracy.gauss_bonnet_error});
    group.attributes.push_back({"precision_digits", static_cast<std::int32_t>(accuracy.precision_digits)});
}

}  // namespace ricci::app
