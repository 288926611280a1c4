// How far a result is to be trusted, as every result says it: residual_max, gauss_bonnet_error,
// precision_digits.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/flow/flow.h"
#include "io/store/result_group.h"

namespace ricci::app {

void add_accuracy(const MetricAccuracy& accuracy, nlohmann::json& object);
void add_accuracy(const MetricAccuracy& accuracy, ResultGroup& group);

}  // namespace ricci::app
