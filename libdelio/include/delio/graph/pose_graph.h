#pragma once
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <vector>

#include "delio/core/increment.h"
#include "delio/core/stage_options.h"

namespace delio::graph {
struct WhitenedGraph;

/** A measured relative pose between two nodes: T_to = T_from + increment.pose. */
struct Edge {
    std::size_t from = 0;  //!< node whose frame the increment maps to
    std::size_t to = 0;    //!< node whose frame it maps from
    Increment increment;   //!< `to` to `from`, covariance in the frame of `to`
};

/** Where a node is. */
struct NodePose {
    std::size_t node = 0;                                    //!< its number
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< node's frame to the graph's
};

/** Construction and optimisation of a graph. */
struct PoseGraphOptions : StageOptions {
    /** More edges than the chain (i,i+1): 1 adds (i,i+2), 2 adds (i,i+3) too, as long as the two
     *  scans overlap by `min_overlap` (TranslationEstimate::overlap). Used by the builder of the
     *  graph; optimise() uses all added edges. */
    unsigned skip_edges = 0;
    double min_overlap = 0.5;
    /** Number of latest nodes optimised during the drive, used by the builder of the graph; 0:
     *  none. */
    unsigned window = 0;
    unsigned max_iterations = 100;
    /** Width c of the Geman-McClure kernel: an edge costs s / (1 + s/c^2) with s = e' Omega e, so c
     *  is a count of standard deviations, and no edge ever costs more than c^2. 0: no kernel. */
    double kernel_width = 10;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Result of an optimisation. */
struct OptimisationResult {
    double initial_cost = 0;  //!< F before (no factor 1/2; robust if there is a kernel)
    double final_cost = 0;    //!< F after; never more than before
    unsigned iterations = 0;  //!< Levenberg-Marquardt steps tried
    bool converged = true;    //!< false where max_iterations ended it
};

/** The pose graph of the paper's section V: F(x) = sum over edges of e' Omega e is minimised over
 *  the poses of all nodes but node 0, which stays where it is. e is [translation,
 *  rotation log] of Z^-1 T_from^-1 T_to with the measured increment Z, Omega the
 *  inverse of the edge's covariance. Poses are metres, in the frame that node 0's pose is given
 *  in. Poses given to addNode are the start of the minimisation, good or poor. */
class PoseGraph {
 public:
    /** Returns the node's index: 0, 1, 2 ... Error for a pose that is not finite. */
    std::size_t addNode(const Eigen::Isometry3d& initial);

    /** Several edges between the same nodes, and edges backwards, are welcome. Error for a node
     *  that does not exist, an edge from a node to itself, a pose that is not finite and a
     *  covariance that is not symmetric and positive definite, or whose inverse is beyond 1e20. */
    void addEdge(const Edge& edge);

    /** The same from an information matrix Omega, which is kept to the bit. */
    void addEdge(std::size_t from, std::size_t to, const Eigen::Isometry3d& pose,
                 const Matrix6& information);

    /** Moves nodes that were measured better since. The edges of the chain (i, i+1) at these nodes
     *  then lead where the nodes are; their covariances stay. Error as addNode(). */
    void correct(const std::vector<NodePose>& corrected);

    /** The same edges between nodes at other poses, one for each node; Error otherwise. */
    PoseGraph withPoses(const std::vector<Eigen::Isometry3d>& poses) const;

    /** Error, naming the node, where a node is not connected to node 0. */
    OptimisationResult optimise(const PoseGraphOptions& options);

    /** Moves the last `count` nodes only, by the edges that they have among themselves and with
     *  earlier nodes, which stay, as node 0 always does. Costs of the result are those of these
     *  edges. From where the nodes are: no detours as in optimise(), which finds its way after
     *  large drift. Error as above. */
    OptimisationResult optimiseLast(std::size_t count, const PoseGraphOptions& options);

    const std::vector<Eigen::Isometry3d>& poses() const { return poses_; }  //!< of all nodes
    /** In the order in which they were added. */
    const std::vector<Edge>& edges() const { return edges_; }
    /** Omega of edges()[i], in the order of delio::Increment. */
    Matrix6 information(std::size_t i) const;

 private:
    void append(const Edge& edge, const Matrix6& information);  //!< without keeping the latter
    void requireConnected(std::size_t firstFree) const;
    /** Edges between free nodes, and between those and earlier ones. */
    WhitenedGraph whitened(std::size_t firstFree, const std::vector<bool>& doubtful) const;
    void takeFreePoses(const WhitenedGraph& graph);

    std::vector<Eigen::Isometry3d> poses_;
    std::vector<Edge> edges_;
    std::map<std::size_t, Matrix6> information_;       //!< of edges that came with it
    std::vector<std::vector<std::size_t>> edgesUpTo_;  //!< of each node: edges to earlier ones
};

/** Converts an increment to MRPT's PDF: the covariance is that of the pose's own numbers x y z yaw
 *  pitch roll, x y z along the axes of the earlier frame; metres and radians. At a pitch of +-90
 *  deg, where yaw and roll are one, it does not exist. */
mrpt::poses::CPose3DPDFGaussian posePdfOf(const Increment& increment);
}  // namespace delio::graph
