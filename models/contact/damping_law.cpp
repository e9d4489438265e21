// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/damping_law.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <string>

#include "models/contact/damping/carvalho_martins.hpp"
#include "models/contact/damping/exact.hpp"
#include "models/contact/damping/flores.hpp"
#include "models/contact/damping/gonthier.hpp"
#include "models/contact/damping/herbert_mcwhannell.hpp"
#include "models/contact/damping/herbert_mcwhannell_implicit.hpp"
#include "models/contact/damping/hertz_hysteresis.hpp"
#include "models/contact/damping/hu_guo.hpp"
#include "models/contact/damping/hunt_crossley.hpp"
#include "models/contact/damping/jankowski.hpp"
#include "models/contact/damping/kuwabara_kono.hpp"
#include "models/contact/damping/lankarani_nikravesh.hpp"
#include "models/contact/damping/lankarani_nikravesh_implicit.hpp"
#include "models/contact/damping/lee_wang.hpp"
#include "models/contact/damping/marhefka_orin.hpp"
#include "models/contact/damping/no_damping.hpp"
#include "models/contact/damping/safaeifar_farshidianfar.hpp"
#include "models/contact/damping/tangent.hpp"
#include "models/contact/damping/tsuji.hpp"
#include "models/contact/damping/tsuji_exact.hpp"
#include "models/contact/damping/tsuji_marshall.hpp"
#include "models/contact/damping/viscous.hpp"
#include "models/contact/damping/zhiying_qishao.hpp"

namespace impactrig::models {
namespace {

template <typename Law>
constexpr DampingLaw entry() {
  return {Law::text, Law::factor};
}

constexpr std::array laws = {
    entry<NoDamping>(),                   //
    entry<LankaraniNikravesh>(),          //
    entry<ExactRestitution>(),            //
    entry<HuntCrossley>(),                //
    entry<HerbertMcWhannell>(),           //
    entry<LeeWang>(),                     //
    entry<Gonthier>(),                    //
    entry<ZhiyingQishao>(),               //
    entry<Flores>(),                      //
    entry<HuGuo>(),                       //
    entry<CarvalhoMartins>(),             //
    entry<SafaeifarFarshidianfar>(),      //
    entry<MarhefkaOrin>(),                //
    entry<LankaraniNikraveshImplicit>(),  //
    entry<HerbertMcWhannellImplicit>(),   //
    entry<Viscous>(),                     //
    entry<Tsuji>(),                       //
    entry<TsujiMarshall>(),               //
    entry<TsujiExact>(),                  //
    entry<TangentDamping>(),              //
    entry<Jankowski>(),                   //
    entry<KuwabaraKono>(),                //
    entry<HertzHysteresis>(),             //
};

}  // namespace

std::span<const DampingLaw> damping_laws() {
  return laws;
}

const DampingLaw& damping_law(std::string_view name) {
  std::string known;
  for (const DampingLaw& law : laws) {
    if (law.text.name == name) return law;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", law.text.name);
  }
  throw std::invalid_argument(
      fmt::format("contact.damping: there is no damping law '{}'; known are {}", name, known));
}

}  // namespace impactrig::models
