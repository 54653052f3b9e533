#include "depth/pair/stages.hpp"

#include <array>

#include "depth/facets/gauss_sat.hpp"
#include "depth/pair/contact_facets.hpp"
#include "depth/pair/polytope_contact.hpp"
#include "depth/pair/polytope_double.hpp"
#include "depth/pair/polytope_exact.hpp"
#include "depth/pair/polytope_warm_start.hpp"

namespace pd::detail {

namespace {

constexpr bool kNo = false, kYes = true;
constexpr std::uint8_t kTightest = bit_of(Bracket::tightest), kCertified = bit_of(Bracket::certified),
                       kContact = bit_of(Bracket::contact), kBoth = kCertified | kContact, kAll = kBoth | kTightest;

constexpr Stage kStages[] = {
    // name, function, bodies, automatic, brackets, warm, needs
    {"answer_from_contact_facet", answer_from_contact_facet, Bodies::any, kNo, kContact, kNo, Needs::nothing},
    {"answer_from_memory", answer_from_memory, Bodies::any, kNo, kBoth, kYes, Needs::nothing},
    {"answer_few_apart", answer_few_apart, Bodies::few_vertices, kYes, kBoth, kNo, Needs::nothing},
    {"answer_by_gauss_maps", answer_by_gauss_maps, Bodies::few_facets, kYes, kAll, kNo, Needs::nothing},
    {"answer_from_surface", answer_from_surface, Bodies::any, kNo, kBoth, kNo, Needs::certified},
    {"answer_among_many_facets", answer_among_many_facets, Bodies::any, kNo, kAll, kNo, Needs::over_budget},
    {"answer_contact", answer_contact, Bodies::any, kNo, kContact, kNo, Needs::surface},
    {"prove_surface", prove_surface, Bodies::any, kNo, kTightest | kCertified, kNo, Needs::round_origin},
    {"answer_by_exact_expansion", answer_by_exact_expansion, Bodies::any, kNo, kTightest | kCertified, kNo,
     Needs::certified},
    {"answer_by_closest_point", answer_by_closest_point, Bodies::any, kNo, kAll, kNo, Needs::surface},
};

bool is_for(const Stage& stage, const PolytopeQuery& query) {
  return (stage.brackets & bit_of(query.bracket)) != 0 && (!stage.warm || query.warm != nullptr) &&
         (!stage.automatic || query.settings.method == Method::automatic);
}

bool suit(Bodies bodies, PolytopeQuery& query) {
  switch (bodies) {
    case Bodies::any:
      return true;
    case Bodies::few_vertices:
      return !query.difference.climbs() && !query.boxes();
    case Bodies::few_facets:
      return query.boxes() || gauss_sat_applies(*query.pair.a, *query.pair.b);
  }
  return false;
}

bool is_met(Needs needs, const ExpansionResult& surface) {
  switch (needs) {
    case Needs::nothing:
    case Needs::surface:
      return true;
    case Needs::round_origin:
      return surface.lower > 0 && surface.face >= 0;
    case Needs::certified:
      return surface.status == ExpansionStatus::certified;
    case Needs::over_budget:
      return surface.status == ExpansionStatus::over_budget && surface.lower > 0;
  }
  return false;
}

}  // namespace

std::span<const Stage> stages() { return kStages; }

std::string_view name_of(Bodies bodies) {
  constexpr std::array<std::string_view, 3> kNames = {"any", "few vertices, not two boxes",
                                                      "solids of up to 32 vertices and 64 facets"};
  return kNames[static_cast<std::size_t>(bodies)];
}

std::string_view name_of(Needs needs) {
  constexpr std::array<std::string_view, 5> kNames = {"nothing", "a surface", "a surface round the origin",
                                                      "a certified surface", "a surface over its budget"};
  return kNames[static_cast<std::size_t>(needs)];
}

const Stage& answer_by_stages(PolytopeQuery& query, PenetrationDepth& out) {
  bool grown = false;
  for (const Stage& stage : kStages) {
    if (!is_for(stage, query) || !suit(stage.bodies, query)) continue;
    if (stage.needs != Needs::nothing && !grown) {
      query.surface = grow_surface(query, out);
      grown = true;
    }
    if (is_met(stage.needs, query.surface) && stage.answer(query, out)) return stage;
  }
  return kStages[std::size(kStages) - 1];
}

}  // namespace pd::detail
