#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

namespace delio {
/** nanoflann's k-d tree over the columns of a matrix, which must outlive it. Distances are squared.
 *  Queries may run in parallel. */
class KdTree {
 public:
    /** `leaf`: columns that are compared one by one; many of them where there are few questions. */
    explicit KdTree(const Eigen::Matrix3Xf& points, std::size_t leaf = 10)
        : columns_{points}, tree_(3, columns_, nanoflann::KDTreeSingleIndexAdaptorParams(leaf)) {
        if (points.cols() > 0) tree_.buildIndex();
    }
    KdTree(const KdTree&) = delete;
    KdTree& operator=(const KdTree&) = delete;

    /** Fills the nearest `count` columns and their squared distances, nearest first; returns how
     *  many there are. */
    std::size_t nearest(const Eigen::Vector3f& query, std::size_t count, std::uint32_t* indices,
                        float* squaredDistances) const {
        return columns_.points.cols() == 0
                   ? 0
                   : tree_.knnSearch(query.data(), count, indices, squaredDistances);
    }

    /** Finds the nearest column, if it is nearer than the root of `squared`: sets its index and its
     *  squared distance. Otherwise false. */
    bool nearestWithin(const Eigen::Vector3f& query, std::uint32_t& index, float& squared) const {
        if (columns_.points.cols() == 0) return false;
        const float most = squared;
        nanoflann::KNNResultSet<float, std::uint32_t> nearest(1);
        nearest.init(&index, &squared);
        squared = most;
        tree_.findNeighbors(nearest, query.data(), nanoflann::SearchParams());
        return nearest.size() > 0;
    }

    /** Columns nearer than the root of `squaredRadius`, in the tree's order. */
    void within(const Eigen::Vector3f& query, float squaredRadius,
                std::vector<std::pair<std::uint32_t, float>>& found) const {
        found.clear();
        if (columns_.points.cols() == 0) return;
        nanoflann::SearchParams unsorted;
        unsorted.sorted = false;
        tree_.radiusSearch(query.data(), squaredRadius, found, unsorted);
    }

 private:
    struct Columns {
        const Eigen::Matrix3Xf& points;
        std::size_t kdtree_get_point_count() const {
            return static_cast<std::size_t>(points.cols());
        }
        float kdtree_get_pt(std::uint32_t i, std::size_t axis) const {
            return points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i));
        }
        template <class Box>
        bool kdtree_get_bbox(Box&) const {
            return false;
        }
    };
    Columns columns_;
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Columns>, Columns, 3,
                                        std::uint32_t>
        tree_;
};
}  // namespace delio
