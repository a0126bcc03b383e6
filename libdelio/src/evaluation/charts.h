#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "delio/evaluation/comparison.h"

namespace delio::evaluation {
/** A plot as gnuplot wants it: a file of numbers, and a script that draws them as NAME.svg and
 *  NAME.png. */
class Chart {
 public:
    /** The columns of a data file, one row per point. */
    using Rows = std::vector<std::vector<double>>;

    /** `name`: of its files, without extension, of letters, digits, '-' and '_'. */
    Chart(std::string name, std::string caption);

    /** Labels of the two axes, with units. */
    void label(const std::string& x, const std::string& y);
    /** A line of gnuplot before the plot, e.g. "set logscale y". */
    void set(const std::string& command);

    /** Draws `rows` (of finite numbers, a point each) as `style` says, e.g. "with lines lw 2". The
     *  key shows `title`, whatever characters it has; an empty one is left out of it. A curve
     *  without points is not drawn. */
    void curve(const std::string& title, const std::string& style, const Rows& rows);

    bool empty() const { return curves_.empty(); }           //!< no curve has a point
    const std::string& name() const { return name_; }        //!< of its files, without extension
    const std::string& caption() const { return caption_; }  //!< that a page shows with it
    /** Content of NAME.dat. */
    const std::string& data() const { return data_; }
    std::string script() const;  //!< what goes into NAME.gp

 private:
    std::string name_, caption_;
    std::string settings_, data_;
    std::vector<std::string> curves_;
};

/** Writes data and script of every chart into `folder`, which exists, and runs gnuplot there.
 *  Throws Error where gnuplot is not installed (it names the package) or fails. */
void drawCharts(const std::vector<Chart>& charts, const std::string& folder);

/** The colour of an estimate in every plot and table, "#rrggbb": safe for red-green colour
 *  blindness. They come again after the eighth estimate. Red is left to the
 *  ground truth. */
std::string colourOf(std::size_t estimate);

constexpr const char* kTruthColour = "#e03131";

/** Mean errors of the segments of about one length, or one speed. */
struct CurvePoint {
    double at = 0;              //!< length in metres, or speed in km/h
    double t_percent = 0;       //!< translation error per length, in percent
    double r_deg_per_100m = 0;  //!< rotation error per length, in deg per 100 m
};

/** Errors over the length of the segments, as KITTI's development kit plots them: all segments of
 *  all of the estimate's sequences, and no point where fewer than three segments are. */
std::vector<CurvePoint> errorOverLength(const std::vector<const Comparison*>& sequences);

/** Errors over the mean speed of the segments: the kit's points are 2, 4, 6 ... m/s, each with the
 *  segments that are less than 2 m/s off it (so neighbours share segments). The kit ends at 24 m/s;
 *  here the points go on to the fastest segment. */
std::vector<CurvePoint> errorOverSpeed(const std::vector<const Comparison*>& sequences);

/** An estimate's sequences, or a sequence's estimates. */
struct Group {
    std::string name;
    std::vector<const Comparison*> members;
    std::vector<std::size_t> estimates;  //!< of each member: which estimate it is, from 0
};

/** Errors over length and speed of the segments, over all sequences of each estimate. */
std::vector<Chart> overviewCharts(const std::vector<Group>& byEstimate);

/** Trajectory, height, and errors over time of one sequence; the charts' names begin with
 *  `prefix`. */
std::vector<Chart> sequenceCharts(const Group& sequence, const std::string& prefix);
}  // namespace delio::evaluation
