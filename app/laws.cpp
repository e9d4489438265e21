// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/files.hpp"
#include "app/law_numbers.hpp"
#include "app/law_pictures.hpp"
#include "app/law_texts.hpp"
#include "app/program.hpp"
#include "datasets/units.hpp"
#include "fitting/toml_reader.hpp"

namespace impactrig::app {
namespace {

struct Options {
  std::string law;
  std::string rig;
  std::string compared;  // rig of --compare; without one the shipped example
  CLI::Option* compare_option = nullptr;
  bool table = false;
  std::string penetration;
  std::string load;  // value of --force; without one that option is the usual permission
  CLI::Option* load_option = nullptr;
  std::optional<double> restitution;
  std::string output;
  CommonOptions common;

  bool compares() const { return compare_option->count() > 0; }

  bool overwrites() const { return common.force || (load_option->count() > 0 && load.empty()); }
};

template <typename Laws>
bool lists(const Laws& laws, std::string_view name) {
  return std::ranges::any_of(laws, [&](const auto& law) { return law.text.name == name; });
}

/// Whether a text with commas names a law where a file's name is meant.
bool lists_a_law(const std::string& text) {
  return !std::filesystem::exists(text) &&
         std::ranges::any_of(split_names(text), [](const std::string& name) {
           return lists(models::elastic_laws(), name) || lists(models::damping_laws(), name);
         });
}

[[noreturn]] void refuse_unknown(const std::string& name) {
  std::vector<std::string_view> known;
  for (const auto& law : models::elastic_laws()) known.push_back(law.text.name);
  for (const auto& law : models::damping_laws()) known.push_back(law.text.name);
  const std::string_view nearest = fitting::nearest_name(name, known);
  throw CLI::ValidationError(
      "LAW", fmt::format("there is no law '{}'; {}", name,
                         nearest.empty() ? "`impactrig laws` lists those there are"
                                         : fmt::format("did you mean '{}'?", nearest)));
}

/// Options that say nothing of what was asked are not passed over.
void check_options(const Options& options, bool elastic) {
  const auto refuse = [](const char* option, const std::string& problem) {
    throw CLI::ValidationError(option, problem);
  };
  const bool placed = !options.penetration.empty() || !options.load.empty();
  if (placed && !elastic)
    refuse(options.load.empty() ? "--penetration" : "--force",
           options.law.empty()
               ? "is for one elastic law; name it"
               : fmt::format("'{}' is a damping law; --restitution is for those", options.law));
  if (options.restitution && elastic)
    refuse("--restitution", fmt::format("'{}' is an elastic law; --penetration and --force are for "
                                        "those",
                                        options.law));
  if (options.compares() && lists_a_law(options.compared))
    refuse("--compare", fmt::format("takes a rig file, for whose contact it compares all laws, not "
                                    "laws: '{}'",
                                    options.compared));
  if (options.output.empty()) return;
  if (options.law.empty() && !options.compares())
    refuse("-o", "draws one law, or with --compare RIG all of them; name one");
  if (!options.output.ends_with(".svg"))
    refuse("-o",
           fmt::format("'{}' is no picture that is drawn here; known is .svg", options.output));
  check_output(options.output, options.overwrites());
}

/// Text or JSON to stdout.
void answer(const Options& options, const std::string& text, const Json& json) {
  fmt::print("{}", options.common.json ? json.dump(2) + "\n" : text);
}

void draw(const Options& options, const std::string& svg) {
  if (!options.output.empty()) write_output(options.output, svg + "\n", options.overwrites());
}

/// As --penetration or --force has it, else as deep as an elastic impact of the rig.
double asked_penetration(const Options& options, const LawScene& scene,
                         const models::ElasticLaw& law) {
  const double limit = models::limit_penetration(law);
  double depth = models::penetration_storing(law, scene.energy);
  if (!options.penetration.empty()) {
    depth = datasets::parse_quantity(options.penetration, "m").value;
    if (depth > limit)
      throw CLI::ValidationError("--penetration", fmt::format("the law ends at {:.4g} m, found {}",
                                                              limit, options.penetration));
  }
  if (!options.load.empty()) {
    const double force = datasets::parse_quantity(options.load, "N").value;
    if (force > models::elastic_force(law, limit))
      throw CLI::ValidationError("--force",
                                 fmt::format("the law ends at {:.4g} N, found {}",
                                             models::elastic_force(law, limit), options.load));
    depth = models::penetration_at(law, force);
  }
  if (!(depth > 0.0))
    throw CLI::ValidationError(options.load.empty() ? "--penetration" : "--force",
                               "must be greater than 0");
  return depth;
}

void tell_elastic(const Options& options, const LawScene& scene) {
  const LawContact choice = with_elastic(scene, options.law);
  const double depth = asked_penetration(options, scene, models::elastic_law(choice.contact));
  const ElasticFigures figures = elastic_figures(choice.contact, depth);
  draw(options, elastic_picture(choice.contact, figures));
  answer(options, elastic_text(scene, choice, figures), elastic_json(scene, choice, figures));
}

void tell_damping(const Options& options, const LawScene& scene) {
  const double e = options.restitution.value_or(scene.rig.contact.restitution);
  const models::Contact contact = with_damping(scene, options.law, e, !options.restitution);
  const DampingFigures figures = damping_figures(scene, contact);
  draw(options, damping_picture(options.law, figures));
  answer(options, damping_text(scene, options.law, figures),
         damping_json(scene, options.law, figures));
}

/// The picture of a comparison is drawn in any case: without -o as laws.svg, unless that is there.
void draw_comparison(const Options& options, const std::string& svg) {
  const std::string name = options.output.empty() ? "laws.svg" : options.output;
  const bool kept =
      options.output.empty() && !options.overwrites() && std::filesystem::exists(name);
  if (!kept) write_output(name, svg + "\n", options.overwrites());
  if (options.common.quiet) return;
  if (kept)
    fmt::print(stderr, "impactrig: {} is kept; -o names another picture, -f overwrites\n", name);
  else
    fmt::print(stderr, "impactrig: picture in {}\n", name);
}

void tell_comparison(const Options& options, const LawScene& scene) {
  const LawComparison comparison = compare_laws(scene);
  for (const Refusal& refusal : comparison.refused)
    if (!options.common.quiet)
      fmt::print(stderr, "impactrig: {} left out: {}\n", refusal.law, refusal.reason);
  draw_comparison(options, comparison_picture(scene, comparison));
  answer(options, comparison_text(scene, comparison), comparison_json(scene, comparison));
}

void laws(const Options& options) {
  auto overrides = split_overrides(options.common.overrides);
  const bool elastic = lists(models::elastic_laws(), options.law);
  if (!options.law.empty() && !elastic && !lists(models::damping_laws(), options.law))
    refuse_unknown(options.law);
  check_options(options, elastic);
  // a stiffness is meant for the law asked about
  if (elastic && std::ranges::find(overrides, "contact.stiffness", &fitting::Override::first) !=
                     overrides.end())
    overrides.emplace_back("contact.law", options.law);
  if (options.table) {
    const LawScene scene = law_scene(options.rig, overrides);
    const std::vector<ReboundRow> rows = rebound_table(scene);
    answer(options, table_text(scene, rows), table_json(scene, rows));
  } else if (options.compares()) {
    tell_comparison(options, law_scene(options.compared, overrides));
  } else if (options.law.empty()) {
    answer(options, list_text(), list_json());
  } else if (elastic) {
    tell_elastic(options, law_scene(options.rig, overrides));
  } else {
    tell_damping(options, law_scene(options.rig, overrides));
  }
}

}  // namespace

void add_laws(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("laws", "List the contact laws, or tell of one, or compare them");
  CLI::Option* law = command->add_option("LAW", options->law, "A law, elastic or damping");
  CLI::Option* rig =
      command->add_option("--rig", options->rig, "Rig file; without one the shipped example");
  CLI::Option* penetration = command->add_option("--penetration", options->penetration,
                                                 "Elastic law: at this depth, \"10 um\"");
  options->load_option =
      command
          ->add_option("--force", options->load,
                       "Elastic law: at this force, \"1 kN\"; without a value: as -f")
          ->expected(0, 1);
  command
      ->add_option("--restitution", options->restitution, "Damping law: for this e, not the rig's")
      ->needs(law);
  CLI::Option* table = command->add_flag(
      "--table", options->table, "What e_in comes out as, all damping laws, three elastic ones");
  CLI::Option* compare = command
                             ->add_option("--compare", options->compared,
                                          "All laws for the contact of this rig file, without one "
                                          "of the shipped example, as a table and a picture: "
                                          "laws.svg unless -o names it")
                             ->expected(0, 1);
  options->compare_option = compare;
  command->add_option("-o,--output", options->output, "Picture (.svg)")->excludes(table);
  command->add_flag("-f", options->common.force, "Overwrite files that exist");
  penetration->needs(law)->excludes(options->load_option);
  table->excludes(law)->excludes(compare);
  compare->excludes(law)->excludes(rig);
  add_json(*command, options->common);
  add_quiet(*command, options->common);
  add_set(*command, options->common);
  command->callback([options] { laws(*options); });
}

}  // namespace impactrig::app
