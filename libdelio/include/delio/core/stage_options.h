#pragma once
#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/config/CLoadableOptions.h>

#include <iosfwd>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace delio {
class StageOptions;

/** One option of a stage: key, member, meaning and allowed values. */
struct OptionField {
    /** `meaning`: one line with the unit, written above the key. */
    template <class Stage, typename Number>
    OptionField(std::string key_, Number Stage::*member_, std::string meaning_, double min_ = 0,
                double max_ = 1e9)
        : key(std::move(key_)),
          member(static_cast<Number StageOptions::*>(member_)),
          meaning(std::move(meaning_)),
          min(min_),
          max(max_) {}
    /** An option that is one of a few words. */
    template <class Stage>
    OptionField(std::string key_, std::string Stage::*member_, std::string meaning_,
                std::vector<std::string> words_)
        : key(std::move(key_)),
          member(static_cast<std::string StageOptions::*>(member_)),
          meaning(std::move(meaning_)),
          words(std::move(words_)) {}

    /** The same, scaled by StageOptions::scaleBy(). */
    OptionField scaled() && {
        scales = true;
        return std::move(*this);
    }

    std::string key;  //!< in its section
    /** Where its value is. */
    std::variant<double StageOptions::*, unsigned StageOptions::*, bool StageOptions::*,
                 std::string StageOptions::*>
        member;
    std::string meaning;             //!< with the unit
    double min = 0;                  //!< smallest allowed number
    double max = 0;                  //!< largest allowed number
    std::vector<std::string> words;  //!< of a text: what it may be
    bool scales = false;             //!< a length, given for streets, that follows the place's size
};

/** Base of each stage's options. A stage names every option once, in fields(); reading is strict:
 *  an unknown key, a malformed number or a value out of range throws delio::Error naming
 *  `section.key`. A key that is absent keeps its value. */
class StageOptions : public mrpt::config::CLoadableOptions {
 public:
    /** Takes over the keys of a section; Error as above. */
    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    /** Writes every key into a section. */
    void saveToConfigFile(mrpt::config::CConfigFileBase& target,
                          const std::string& section) const override;

    /** Writes `[section]` with each key under its meaning, numbers with as many digits as give
     *  the same value when they are read again. */
    void write(std::ostream& out, const std::string& section) const;

    /** Multiplies every option that scales with the size of the place. */
    void scaleBy(double factor);

    /** Throws an Error naming both options if two options contradict each other. Not called while
     *  loading, because options change one by one. */
    virtual void check(const std::string& /*section*/) const {}

 protected:
    /** Every option of the stage, once. */
    virtual std::vector<OptionField> fields() const = 0;
};

/** For check(): Error unless `low` <= `high`; both named as `section.key`. */
void requireOrder(const std::string& lowName, double low, const std::string& highName, double high);
}  // namespace delio
