#pragma once
#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

#include "delio/evaluation/comparison.h"

namespace delio {
/** An estimate as the command line of delio-eval names it. */
struct Estimate {
    std::string name;
    std::string path;
};

/** `[NAME=]PATH`, named after the file or folder where no name is given. */
Estimate estimateOf(const std::string& text);

/** Message about invalid names of estimates; empty if they are valid. */
std::string faultOfNames(const std::vector<Estimate>& estimates);

struct EvalSettings {
    std::optional<Eigen::Isometry3d> Tr;  //!< set: estimates are brought from LiDAR to cam0
    evaluation::ComparisonSettings comparison;
    bool verbose = false;
};

/** "100,200,400". */
std::string textOf(const std::vector<double>& lengths);

/** Reads and scores one pose file against another. Flagged scans and times are taken from the
 *  scans.csv of delio-slam where there is one beside the estimate. Warnings go to stderr; Error for
 *  what cannot be compared. */
evaluation::Comparison compareFiles(const std::string& name, const std::string& referenceFile,
                                    const std::string& estimateFile, const EvalSettings& settings);

/** All sequences of one estimate. `reference` is a pose file, and the estimate one too or a folder
 *  of delio-slam; or it is a folder of NN.txt, and the estimate one of NN.txt or of folders NN.
 *  Where delio-slam closed loops, the odometry alone is scored, too, after them. */
std::vector<evaluation::Comparison> compareSequences(const std::string& reference,
                                                     const Estimate& estimate,
                                                     const EvalSettings& settings);
}  // namespace delio
