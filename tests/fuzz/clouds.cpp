#include <array>

#include "scans.h"

/** A folder with a scan a file, or its list of times. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    static const std::array<const char*, 7> kNames{"a.pcd", "a.ply",     "a.bin", "a.txt",
                                                   "a.csv", "times.txt", "a.las"};
    Input input(data, size);
    const std::string name = kNames[input.pick(kNames.size())];
    if (name == "times.txt") fileOf(std::string(16, '\0'), "drive/a.bin");
    fileOf(input.rest(), "drive/" + name);
    readScans({(folder() / "drive").string(), "", "", ""});
    fs::remove_all(folder() / "drive");
    return 0;
}
