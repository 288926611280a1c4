// Pictures of distances between shapes: the matrix as a heat map (thesis Table 6), and their dendrogram.
#pragma once

#include <string>
#include <vector>

#include "engine/shape_space/clustering.h"
#include "io/picture/svg.h"

namespace ricci::app {

/// The matrix with rows and columns in the order given (the dendrogram's leaves), a colour bar, and the names
/// of the shapes where there is room. Above 300 shapes, neighbouring ones share a cell that shows their mean.
/// Throws std::invalid_argument unless there is a name for each shape, and the order names each once.
SvgPicture draw_distances(const DistanceMatrix& distances, const std::vector<std::size_t>& order,
                          const std::vector<std::string>& names, const std::string& title);

/// The tree from the root on the left to the shapes on the right over an axis of heights, clusters (one
/// number per shape, flat_clusters) told apart by colours; names as above. Throws std::invalid_argument
/// unless there is a name and a cluster for each shape.
SvgPicture draw_dendrogram(const Dendrogram& tree, const std::vector<std::size_t>& clusters,
                           const std::vector<std::string>& names, const std::string& title);

/// An empty picture in pixels with its title in the upper left corner.
SvgPicture titled_picture(double width, double height, double margin, const std::string& title);

/// The names of files without the folders they share.
std::vector<std::string> short_names(const std::vector<std::string>& names);

}  // namespace ricci::app
