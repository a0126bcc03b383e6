// Files that were damaged or made to do harm, and once crashed a tool or took all memory.
#include <gtest/gtest.h>

#include <chrono>

#include "delio/core/error.h"
#include "delio/picture/scene.h"
#include "delio/recordings/rawlog_reader.h"
#include "memory_limit.h"
#include "test_data.h"

namespace {
using namespace delio;

/** What is said of it, with little memory and within a few seconds; empty where it is read. */
std::string faultOf(const std::string& file) {
    const std::string path = test::dataFolder() / "damaged" / file;
    const test::MemoryLimit limit(900);
    const auto begin = std::chrono::steady_clock::now();
    std::string fault;
    try {
        if (file.find(".3Dscene") != std::string::npos) {
            picture::loadScene(path);
        } else {
            io::RawlogReader reader(path);
            while (reader.next()) continue;
        }
    } catch (const Error& e) {
        fault = e.what();
        EXPECT_NE(fault.find(file), std::string::npos) << fault;
        EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5)) << file;
    return fault;
}

TEST(Damaged, FilesAreRefusedInOneLine) {
    DELIO_NEED_DATA("damaged");
    const std::pair<const char*, const char*> files[] = {
        {"crash-assimp-20099.rawlog", "'mrpt::opengl::CAssimpModel'"},
        {"crash-rawlog-gz-20004.rawlog", "damaged"},
        {"crash-rawlog-other-classes-20022.rawlog", "'mrpt::opengl::CAssimpModel'"},
        {"crash-rawlog-plain-1049.rawlog", "damaged"},
        {"crash-rawlog-plain-20073.rawlog", "damaged"},
        {"mem-20022.3Dscene", "is not a .3Dscene, or it is cut off"},
        {"min-assimp.rawlog", "'mrpt::opengl::CAssimpModel'"},
        {"min-coloured-pointsmap.rawlog", "damaged"},
        {"outside-names.rawlog", "'../abc.bin' leads out of the folder"},
        {"terminal-escape.rawlog", "is in none of the folders"},
        {"two-labels.rawlog", "'000000.bin' is in none of the folders"},
    };
    for (const auto& [file, words] : files)
        EXPECT_NE(faultOf(file).find(words), std::string::npos) << file << ": " << faultOf(file);
}

TEST(Damaged, DepthScansInExternalFilesAreFoundBesideTheirRawlog) {
    DELIO_NEED_DATA("damaged");
    EXPECT_EQ(faultOf("tiny_3dext.rawlog"), "");
}
}  // namespace
