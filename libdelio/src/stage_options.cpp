#include "delio/stage_options.h"

#include <algorithm>
#include <charconv>
#include <ostream>

#include "delio/error.h"

namespace delio {
namespace {
template <typename Number>
std::string shortestText(Number value) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
    return {text, end};
}

std::string textOf(const OptionField& field) {
    if (const auto* flag = std::get_if<bool*>(&field.value)) return **flag ? "true" : "false";
    if (const auto* count = std::get_if<unsigned*>(&field.value)) return shortestText(**count);
    return shortestText(*std::get<double*>(field.value));
}

template <typename Number>
void parse(const std::string& name, const std::string& text, const OptionField& field, Number& to) {
    Number value{};
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    const double number = static_cast<double>(value);
    // Written so that a NaN fails as well.
    const bool inRange = number >= field.min && number <= field.max;
    if (fault != std::errc{} || end != text.data() + text.size() || !inRange)
        throw Error("option " + name + ": '" + text + "' is not a " +
                    (std::is_same_v<Number, double> ? "number" : "whole number") + " from " +
                    shortestText(field.min) + " to " + shortestText(field.max) + " (" +
                    field.meaning + ")");
    to = value;
}

void parse(const std::string& name, const std::string& text, const OptionField&, bool& to) {
    if (text != "true" && text != "false")
        throw Error("option " + name + ": '" + text + "' is neither 'true' nor 'false'");
    to = text == "true";
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
        std::visit([&](auto* value) { parse(name, text, *field, *value); }, field->value);
    }
}

void StageOptions::saveToConfigFile(mrpt::config::CConfigFileBase& target,
                                    const std::string& section) const {
    for (const auto& field : readableFields())
        target.write(section, field.key, textOf(field), -1, -1, field.meaning);
}

void StageOptions::write(std::ostream& out, const std::string& section) const {
    out << "[" << section << "]\n";
    for (const auto& field : readableFields())
        out << "# " << field.meaning << "\n" << field.key << " = " << textOf(field) << "\n";
}

std::vector<OptionField> StageOptions::readableFields() const {
    // fields() hands out where to write as well; here they are only read.
    return const_cast<StageOptions*>(this)->fields();
}
}  // namespace delio
