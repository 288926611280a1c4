#include "kernels/lanes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "kernels/triangle.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A face at u = 0; corner k is the tail of its halfedge k.
struct FaceShape {
    long double square[3];  // opposite corner k, over four times the area
    long double cot[3];
    long double angle[3];
};

FaceShape shape_of(const long double* log_chord, Index face) {
    const long double top = std::max(log_chord[0], std::max(log_chord[1], log_chord[2]));
    long double chord[3];
    for (int k = 0; k < 3; ++k) chord[k] = std::exp(log_chord[k] - top);
    const auto t = triangle_terms<0>(chord[0], chord[1], chord[2]);
    if (!(t.radicand > 0) || !std::isfinite(top))
        throw std::invalid_argument("face " + std::to_string(face) + " is no triangle");
    FaceShape shape;
    for (int k = 0; k < 3; ++k) {
        shape.square[k] = chord[(k + 1) % 3] * chord[(k + 1) % 3] / t.root;
        shape.cot[k] = t.numerator[k] / t.root;
        shape.angle[k] = std::atan2(t.root, t.numerator[k]);
    }
    return shape;
}

}  // namespace

LaneFaces make_lane_faces(const Connectivity& connectivity, std::span<const long double> log_chord,
                          std::span<const Index> row_of) {
    LaneFaces faces;
    const std::size_t halfedges = connectivity.tail.size();
    for (auto* corners : {&faces.row, &faces.corner}) corners->reserve(halfedges);
    for (auto* corners : {&faces.square, &faces.angle}) corners->reserve(halfedges);
    faces.cot.reserve(halfedges / 3 * 2);
    for (Index f = 0; f < connectivity.face_count(); ++f) {
        const FaceShape shape = shape_of(&log_chord[at(3 * f)], f);
        int right = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(shape.cot[k]) < std::abs(shape.cot[right])) right = k;
        for (int c = 0; c < 3; ++c) {
            const int k = (right + 1 + c) % 3;
            faces.row.push_back(row_of[at(connectivity.tail[at(3 * f + k)])]);
            faces.square.push_back(static_cast<double>(shape.square[k]));
            faces.angle.push_back(static_cast<double>(shape.angle[k]));
            faces.corner.push_back(3 * f + k);
            if (c < 2) faces.cot.push_back(static_cast<double>(shape.cot[k]));
        }
    }
    return faces;
}

LaneEdges make_lane_edges(const Connectivity& connectivity, std::span<const long double> log_chord,
                          std::span<const Index> row_of) {
    LaneEdges edges;
    const auto row = [&](Index h) { return row_of[at(connectivity.tail[at(h)])]; };
    for (Index h = 0; h < connectivity.halfedge_count(); ++h) {
        const Index twin = connectivity.twin[at(h)];
        if (twin < h || face_of(twin) == face_of(h)) continue;
        const long double ij = log_chord[at(h)];
        const long double jk = log_chord[at(next_halfedge(h))], ki = log_chord[at(prev_halfedge(h))];
        const long double jl = log_chord[at(prev_halfedge(twin))], li = log_chord[at(next_halfedge(twin))];
        for (const Index corner : {h, next_halfedge(h), prev_halfedge(h), prev_halfedge(twin)})
            edges.row.push_back(row(corner));
        for (const long double weight :
             {std::exp(jk - ki) + std::exp(jl - li), std::exp(ki - jk) + std::exp(li - jl),
              std::exp(2 * ij - jk - ki), std::exp(2 * ij - jl - li)})
            edges.square.push_back(static_cast<double>(weight));
        edges.face.push_back(face_of(h));
        edges.face.push_back(face_of(twin));
        edges.halfedge.push_back(h);
    }
    return edges;
}

}  // namespace ricci
