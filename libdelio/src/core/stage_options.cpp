#include "delio/core/stage_options.h"

#include <algorithm>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/text.h"

namespace delio {
namespace {
std::string textOf(bool flag) { return flag ? "true" : "false"; }
std::string textOf(const std::string& word) { return word; }
std::string textOf(unsigned count) { return digitsOf(count); }
std::string textOf(double number) { return digitsOf(number); }

template <typename Number>
void parse(const std::string& name, const std::string& text, const OptionField& field, Number& to) {
    const auto value = numberIn<Number>(text);
    const double number = value ? static_cast<double>(*value) : 0;
    // Written so that a NaN fails as well.
    const bool inRange = number >= field.min && number <= field.max;
    if (!value || !inRange)
        throw Error("option " + name + ": '" + text + "' is not a " +
                    (std::is_same_v<Number, double> ? "number" : "whole number") + " from " +
                    digitsOf(field.min) + " to " + digitsOf(field.max) + " (" + field.meaning +
                    ")");
    to = *value;
}

void parse(const std::string& name, const std::string& text, const OptionField&, bool& to) {
    if (text != "true" && text != "false")
        throw Error("option " + name + ": '" + text + "' is neither 'true' nor 'false'");
    to = text == "true";
}

void parse(const std::string& name, const std::string& text, const OptionField& field,
           std::string& to) {
    std::string known;
    for (const auto& word : field.words) known += (known.empty() ? "" : ", ") + word;
    if (std::find(field.words.begin(), field.words.end(), text) == field.words.end())
        throw Error("option " + name + ": '" + text + "' is not one of: " + known);
    to = text;
}
}  // namespace

void StageOptions::loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                                      const std::string& section) {
    const auto known = fields();
    std::vector<std::string> keys;
    source.getAllKeys(section, keys);
    for (const auto& key : keys) {
        const auto field = std::find_if(known.begin(), known.end(),
                                        [&](const OptionField& f) { return f.key == key; });
        const std::string name = section + "." + key;
        if (field == known.end()) throw Error("option " + name + " does not exist");
        const std::string text = source.read_string(section, key, "");
        std::visit([&](auto member) { parse(name, text, *field, this->*member); }, field->member);
    }
}

void StageOptions::saveToConfigFile(mrpt::config::CConfigFileBase& target,
                                    const std::string& section) const {
    for (const auto& field : fields())
        std::visit(
            [&](auto member) {
                target.write(section, field.key, textOf(this->*member), -1, -1, field.meaning);
            },
            field.member);
}

void StageOptions::write(std::ostream& out, const std::string& section) const {
    out << "[" << section << "]\n";
    for (const auto& field : fields())
        std::visit(
            [&](auto member) {
                out << "# " << field.meaning << "\n"
                    << field.key << " = " << textOf(this->*member) << "\n";
            },
            field.member);
}

void requireOrder(const std::string& lowName, double low, const std::string& highName,
                  double high) {
    if (!(low <= high))
        throw Error("option " + lowName + " (" + digitsOf(low) + ") must be at most " + highName +
                    " (" + digitsOf(high) + ")");
}

void StageOptions::scaleBy(double factor) {
    for (const auto& field : fields())
        if (field.scales) this->*std::get<double StageOptions::*>(field.member) *= factor;
}
}  // namespace delio
