#pragma once
#include <string>
#include <vector>

namespace delio::evaluation {
/** A plot as gnuplot wants it: a file of numbers, and a script that draws them as NAME.svg and
 *  NAME.png. */
class Chart {
 public:
    /** The columns of a file of numbers, a row a point. */
    using Rows = std::vector<std::vector<double>>;

    /** `name`: of its files, without extension, of letters, digits, '-' and '_'. */
    Chart(std::string name, std::string caption);

    /** What is written at the two axes, with the unit. */
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
    /** What goes into NAME.dat. */
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
}  // namespace delio::evaluation
