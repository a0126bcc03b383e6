#include <sstream>

#include "delio/slam/options.h"
#include "target.h"

/** An .ini file, or a word of --set a line. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    const bool words = input.pick(2) == 1;
    Options options;
    return fuzz::mayRefuse([&] {
        std::istringstream lines(words ? input.rest() : "");
        for (std::string word; std::getline(lines, word);) options.set(word);
        if (!words) options.load(input.rest());
        options.check();
        std::ostringstream text;
        options.write(text);
        Options().load(text.str());
    });
}
