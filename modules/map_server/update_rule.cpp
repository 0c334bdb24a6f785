// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/update_rule.hpp"

#include "modules/map_server/confirmed_rule.hpp"
#include "modules/map_server/paper_rule.hpp"

namespace nodmap::map_server {

std::unique_ptr<UpdateRule> make_update_rule(const MapServerParams& params) {
  if (params.update_rule == Rule::kPaper) {
    return std::make_unique<PaperRule>(params.expiry_s);
  }
  return std::make_unique<ConfirmedRule>(params);
}

}  // namespace nodmap::map_server
