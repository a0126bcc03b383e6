#pragma once
#include <array>
#include <string>
#include <vector>

namespace delio::cli {
/** Content of --help besides the summary line and the options, which TCLAP has. */
struct HelpText {
    struct Row {
        std::string name, meaning;
    };

    std::string about;            //!< a paragraph; empty: none
    std::vector<Row> sections;    //!< of --set; empty: there is no --set
    std::vector<Row> writes;      //!< files, what they are
    std::array<Row, 2> examples;  //!< command lines, what they are for
    std::string interrupted;      //!< what is left after Ctrl-C
};
}  // namespace delio::cli
