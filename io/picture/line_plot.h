// Plots of series as lines: convergence, spectra, coordinates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/picture/axis.h"
#include "io/picture/svg.h"

namespace ricci {

/// Points from left to right, in the units of the axes. Points that are not finite, or that an axis does not
/// reach, break the line.
struct PlotSeries {
    std::string name;
    std::vector<PlanePoint> points;
};

/// Words of a plot.
struct PlotLabels {
    std::string title, x, y;
};

/// The smallest axis that shows all values with a margin; logarithmic where that is asked for and positive
/// values exist (others are then not shown). Zero to one where nothing is finite.
Axis axis_around(const std::vector<double>& values, ScaleKind kind);

/// A picture of 560 pixels width: lines with dots, told apart by colour and dashes, listed below the axes
/// where there are several. `reference` marks a height, such as a tolerance.
SvgPicture draw_line_plot(const std::vector<PlotSeries>& series, const Axis& x, const Axis& y,
                          const PlotLabels& labels, std::optional<double> reference = std::nullopt);

}  // namespace ricci
