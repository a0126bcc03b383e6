#include "test_data.h"

#include <unistd.h>

#include <fstream>
#include <sstream>

namespace delio::test {
namespace fs = std::filesystem;

fs::path dataFolder() {
    const char* set = std::getenv("DELIO_DATA");
    return set ? fs::path(set) : fs::path(DELIO_DEFAULT_DATA);
}

fs::path profileFolder() { return DELIO_PROFILES; }

fs::path frozenFolder() { return DELIO_FROZEN; }

bool haveData(const std::string& part) { return fs::exists(dataFolder() / part); }

bool dataIsRequired() {
    const char* set = std::getenv("DELIO_REQUIRE_DATA");
    return set && std::string(set) == "1";
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "delio-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void writeText(const fs::path& path, const std::string& text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string readText(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + path.string());
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}
}  // namespace delio::test
