#pragma once

#include <stroma/base/errors.h>
#include <stroma/base/parameter_file.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace Stroma
{
  /// Allowed interval of a number, in the parameter's own unit.
  struct Range
  {
    double min      = -std::numeric_limits<double>::infinity();
    double max      = std::numeric_limits<double>::infinity();
    bool   open_min = false; ///< min itself is not allowed
    bool   open_max = false; ///< max itself is not allowed

    static Range
    any()
    {
      return {};
    }
    static Range
    positive()
    {
      return {0., std::numeric_limits<double>::infinity(), true, false};
    }
    static Range
    non_negative()
    {
      return {0., std::numeric_limits<double>::infinity(), false, false};
    }
    static Range
    closed(const double min, const double max)
    {
      return {min, max, false, false};
    }
    static Range
    open(const double min, const double max)
    {
      return {min, max, true, true};
    }
    static Range
    at_least(const double min)
    {
      return {min, std::numeric_limits<double>::infinity(), false, false};
    }

    bool        contains(double value) const;
    std::string text() const; ///< for example "(0, inf)"
  };

  /**
   * Strict, self-documenting access to a parameter file. A part of the program calls add() once for each of its
   * entries: that declares the entry (meaning, unit, range), reads it if the file gives it, checks it, converts it
   * to SI and stores it in the caller's variable. finish() then reports whatever the file holds and nobody declared.
   *
   * Numbers may be expressions of the names in the file's `Constants` section ("ratio * mu_c", see base/formula.h).
   * Errors are UserError, one line, naming file and line, and numbers in it have the file's units.
   */
  class Parameters
  {
  public:
    enum class Mode
    {
      read,    ///< required entries must be given
      document ///< for `stroma template`: required entries may be missing
    };

    explicit Parameters(const ParameterFile &file, Mode mode = Mode::read);

    /// Leaves its section when it goes out of scope.
    class Section
    {
    public:
      ~Section();
      Section(const Section &)            = delete;
      Section &operator=(const Section &) = delete;

    private:
      friend class Parameters;
      explicit Section(Parameters &p);
      Parameters &parameters;
      int         n_exceptions; ///< that were under way when it was entered
    };

    /// Enters subsection @p name of the current section. @p meaning is printed by `stroma template`.
    [[nodiscard]] Section section(const std::string &name, const std::string &meaning = "");

    /// Names of the subsections that the file has below the current section, in the file's order.
    std::vector<std::string> subsections() const;

    /// The same where users name things ("support"): throws UserError for names that cannot be folders and columns.
    std::vector<std::string> names(const std::string &kind) const;

    /// Whether the file (or --set) gives this entry of the current section.
    bool given(const std::string &name) const;

    // Each add() keeps the variable's present value as default. A NaN or empty required value must be given.
    // `unit` is a product of powers of m, s, kg, N, Pa, e.g. "N/m^3"; "" means dimensionless. Ranges are in the file's units.

    void add(const std::string &name, double &value, const std::string &meaning, const std::string &unit,
             const Range &range);
    /// Whole numbers are at most largest_whole.
    void add(const std::string &name, unsigned int &value, const std::string &meaning,
             const Range &range = Range::non_negative());
    void add(const std::string &name, bool &value, const std::string &meaning);
    /// Free text. Must be given if @p required.
    void add(const std::string &name, std::string &value, const std::string &meaning, bool required = false);
    /// Path of an existing file, or @p word, which must be given: found from the working directory or else from the
    /// folder of the file that gives it, and kept as an absolute path, so that print() can be read from anywhere.
    void add_file(const std::string &name, std::string &path, const std::string &meaning, const std::string &word);
    /// Comma-separated numbers. @p n = 0: any number of them.
    void add(const std::string &name, std::vector<double> &values, const std::string &meaning, const std::string &unit,
             const Range &range, unsigned int n = 0);
    void add(const std::string &name, std::vector<unsigned int> &values, const std::string &meaning, const Range &range,
             unsigned int n = 0);
    /// Comma-separated words.
    void add(const std::string &name, std::vector<std::string> &values, const std::string &meaning);
    /// One word out of @p choices (the keys); unknown words list the known ones.
    template <typename T>
    void add_choice(const std::string &name, T &value, const std::string &meaning,
                    const std::vector<std::pair<std::string, T>> &choices);

    /// A number inside the text of entry @p name (an expression of the constants), converted to SI.
    double parse_number(const std::string &name, const std::string &text, const std::string &unit,
                        const Range &range = Range::any()) const;

    /// "file:line" of an entry of the current section, or the current section's name where it is not given.
    std::string where(const std::string &name) const;
    /// "file:line" where the current section was first mentioned, or its path.
    std::string where_section() const;

    /// Says that all entries of the current section have been declared, as leaving it does.
    void all_declared();

    /// Throws UnknownEntry for the first section or entry of the file that nobody declared; of several entries of a
    /// section for the one most like a declared name. It tells the declared names, the nearest first.
    /// @param read_by_others sections that a whole file may have besides, to be told with them
    void finish(const std::vector<std::string> &read_by_others = {}) const;

    /**
     * The same where an error has ended the reading, so that not all has been declared: only entries of sections whose
     * entries all have been are looked at, and sections of the file itself if @p known_sections, all that there
     * can be, are given.
     */
    void finish_declared(const std::vector<std::string> &known_sections = {}) const;

    /// Names of the sections of the file itself declared so far.
    std::vector<std::string> declared_sections() const;

    /// All declared entries with their present values, readable by ParameterFile::read.
    /// @param documented with meaning, unit and range above each entry
    std::string print(bool documented) const;

    /// Declared entries as path -> value text, for comparing two scenes.
    const std::map<std::string, std::string> &
    values() const
    {
      return value_texts;
    }

    /// Factor that turns a number of the file with this unit into SI.
    double si_factor(const std::string &unit) const;

    /// @p unit (of SI) as the file's section Units has it: "um" for "m", "nN/um^3" for "N/m^3".
    std::string file_unit(const std::string &unit) const;

    /// @p value (SI) as people read it, in the file's units: "64 um".
    std::string in_file_units(double value, const std::string &unit) const;

    static constexpr unsigned int largest_whole = 2147483647; ///< 2^31 - 1

    /// Numbers of the `Constants` section, for expressions.
    const std::map<std::string, double> &
    constants() const
    {
      return constant_values;
    }

    Mode
    get_mode() const
    {
      return mode;
    }

  private:
    struct Declared
    {
      bool                     is_section;
      std::vector<std::string> path;
      std::string              value, meaning, unit, allowed;
      bool                     given = false;
    };

    using Path = std::vector<std::string>;

    std::vector<std::vector<const ParameterFile::Entry *>> entries_by_section() const;

    void                     check_entries(const std::vector<const ParameterFile::Entry *> &entries) const;
    std::vector<std::string> declared_in(const Path &section, bool are_sections) const;

    std::string                 path_text() const;
    std::string                 key(const std::string &name) const;
    const ParameterFile::Entry *claim(const std::string &name);
    void declare(const std::string &name, const std::string &value, const std::string &meaning, const std::string &unit,
                 const std::string &allowed);
    double      number(const ParameterFile::Entry &entry, const std::string &text, const Range &range,
                       const std::string &unit) const;
    std::string in_brackets(const std::string &unit) const;
    std::string choose(const std::string &name, const std::string &present, const std::string &meaning,
                       const std::vector<std::string> &choices);
    void        read_units();
    void        read_constants();

    const ParameterFile               &file;
    Mode                               mode;
    std::vector<std::string>           current;
    std::vector<Declared>              declared;
    std::set<std::string>              claimed;
    std::set<Path>                     complete; ///< sections whose entries have all been declared
    std::map<std::string, std::string> value_texts;
    std::map<std::string, double>      base_units;
    std::map<std::string, std::string> unit_names; ///< the file's unit for each SI unit
    std::map<std::string, double>      constant_values;
  };

  template <typename T>
  void
  Parameters::add_choice(const std::string &name, T &value, const std::string &meaning,
                         const std::vector<std::pair<std::string, T>> &choices)
  {
    std::vector<std::string> words;
    std::string              present;
    for (const auto &[word, choice] : choices)
      {
        words.push_back(word);
        if (choice == value)
          present = word;
      }
    const std::string chosen = choose(name, present, meaning, words);
    for (const auto &[word, choice] : choices)
      if (word == chosen)
        value = choice;
  }
} // namespace Stroma
