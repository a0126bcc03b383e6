#pragma once
#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/config/CLoadableOptions.h>

#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

namespace delio {
/** One option of a stage: its key, where its value lives, what it means, what it may be. */
struct OptionField {
    std::string key;
    std::variant<double*, unsigned*, bool*> value;
    std::string meaning;  //!< one line with the unit, written above the key in every .ini
    double min = 0;       //!< smallest allowed value; not looked at for a bool
    double max = 1e9;     //!< largest allowed value
};

/** Base of each stage's options. A stage names every option once, in fields(); reading is strict:
 *  an unknown key, a malformed number or a value out of range throws delio::Error naming
 *  `section.key`. A key that is absent keeps its value. */
class StageOptions : public mrpt::config::CLoadableOptions {
 public:
    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    void saveToConfigFile(mrpt::config::CConfigFileBase& target,
                          const std::string& section) const override;

    /** Writes `[section]` with each key under its meaning, numbers with as many digits as give
     *  the same value when they are read again. */
    void write(std::ostream& out, const std::string& section) const;

 protected:
    virtual std::vector<OptionField> fields() = 0;

 private:
    std::vector<OptionField> readableFields() const;
};
}  // namespace delio
