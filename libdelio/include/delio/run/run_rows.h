#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include "core/chunked.h"
#include "delio/slam/slam.h"

namespace delio::run {
/** What is said of one scan: a row of scans.csv. */
struct RunRow {
    std::size_t scan = 0;  //!< number of the scan in its recording
    double stamp_s = 0;    //!< seconds of the drive
    Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();  //!< sensor to vehicle
    std::size_t points = 0;                                        //!< that were used
    double read_ms = 0;                                            //!< time to read it
    ScanReport report;                                             //!< without points and features

    /** Of reading, odometry, pose graph and submaps. */
    double total_ms() const;
};

/** The rows of a drive, each as some forty numbers: names and reasons, which are the same again and
 *  again, are kept once. What has come back has no increment (the trajectory has it): it is the
 *  identity. */
class RunRows {
 public:
    std::size_t size() const { return begins_.size(); }  //!< rows
    bool empty() const { return size() == 0; }           //!< no rows
    void push_back(const RunRow& row);                   //!< the next one
    RunRow operator[](std::size_t i) const;              //!< the row with this number, from 0
    RunRow front() const { return (*this)[0]; }          //!< the first row
    RunRow back() const { return (*this)[size() - 1]; }  //!< the last row

    //! \cond of a range-based for
    class Iterator {
     public:
        using iterator_category = std::input_iterator_tag;
        using value_type = RunRow;
        using difference_type = std::ptrdiff_t;
        using pointer = const RunRow*;
        using reference = RunRow;

        Iterator(const RunRows& rows, std::size_t i) : rows_(&rows), i_(i) {}
        RunRow operator*() const { return (*rows_)[i_]; }
        Iterator& operator++() {
            ++i_;
            return *this;
        }
        bool operator==(const Iterator& other) const { return i_ == other.i_; }
        bool operator!=(const Iterator& other) const { return i_ != other.i_; }

     private:
        const RunRows* rows_;
        std::size_t i_;
    };
    //! \endcond
    Iterator begin() const { return {*this, 0}; }     //!< the first row
    Iterator end() const { return {*this, size()}; }  //!< behind the last row

 private:
    /** Of the figures of a row, in their order. */
    struct Names {
        std::vector<std::string> stages, listeners, details;

        bool operator==(const Names& other) const {
            return stages == other.stages && listeners == other.listeners &&
                   details == other.details;
        }
    };
    void put(double number) { numbers_.push_back(number); }
    void put(const std::vector<Named>& figures);
    void put(const Eigen::Ref<const Eigen::Matrix3Xd>& columns);

    Chunked<std::size_t> begins_;  //!< of each row in the numbers
    Chunked<double> numbers_;
    std::vector<Names> names_;
    std::vector<std::string> reasons_;
    std::vector<Eigen::Isometry3d> sensorPoses_;
};
}  // namespace delio::run
