// Where things lie in the plan of further orders. Twin of the constants in engine/src/air/model/orders.rs, with which tests compare it.

#include "lib/air_orders.wgsl"

const PLAN_DIRECTIONS: u32 = 20u;
const PLAN_STEPS: u32 = 16u;
const PLAN_CLASSES: u32 = 4u;
const PLAN_HEAD: u32 = 2u;
const PLAN_STEP: u32 = 3u + PLAN_CLASSES;
const PLAN_PATH: u32 = PLAN_HEAD + PLAN_STEPS * PLAN_STEP;
const PLAN_KERNELS_AT: u32 = ORDERS_ALTITUDES * PLAN_DIRECTIONS * PLAN_PATH;
const PLAN_DRAWN_AT: u32 = PLAN_KERNELS_AT + ORDERS_ALTITUDES * ORDERS_VIEWS * PLAN_DIRECTIONS * 3u;
const PLAN_MAX_ORDERS: u32 = 8u;
