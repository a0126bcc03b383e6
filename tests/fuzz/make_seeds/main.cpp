#include <iostream>

#include "seeds.h"

/** make_seeds FOLDER: the first inputs of every fuzz target. */
int main(int count, char** words) {
    if (count != 2) {
        std::cerr << "make_seeds FOLDER\n";
        return 2;
    }
    using namespace delio::fuzz;
    root = words[1];
    seedRawlogs();
    seedBags();
    seedMaps();
    seedTexts();
}
