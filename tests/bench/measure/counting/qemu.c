/* Runs the mailbox on QEMU's mps2-an386 and prints answers and ticks by semihosting. */
#include <stdint.h>
#include "uwb_predict.h"
extern float uwb_count_input[UWB_PREDICT_SAMPLES];
extern float uwb_count_output;
extern void uwb_count_call(void);
extern const float qemu_rows[ROWS][UWB_PREDICT_SAMPLES];
extern uint32_t __StackTop;
#define SYST_CSR (*(volatile uint32_t *)0xE000E010)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018)
#define CPACR (*(volatile uint32_t *)0xE000ED88)
static void semihost(int number, const void *what) {
  register int r0 __asm__("r0") = number;
  register const void *r1 __asm__("r1") = what;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}
static void print(uint32_t value) {
  char text[10];
  for (int i = 0; i < 8; i++) {
    uint32_t digit = value >> (28 - 4 * i) & 15u;
    text[i] = (char)(digit < 10 ? '0' + digit : 'a' + digit - 10);
  }
  text[8] = '\n';
  text[9] = 0;
  semihost(4, text);
}
__attribute__((noinline)) static void nothing(void) { __asm__ volatile(""); }
__attribute__((noinline)) static uint32_t ticks(void (*call)(void)) {
  uint32_t start = SYST_CVR;
  for (volatile int i = 0; i < CALLS; i++) call();
  return (start - SYST_CVR) & 0xFFFFFFu;
}
void reset(void) {
  CPACR |= 0xFu << 20;
  __asm__ volatile("dsb\nisb");
  SYST_RVR = 0xFFFFFFu;
  SYST_CVR = 0;
  SYST_CSR = 5;
  for (int row = 0; row < ROWS; row++) {
    for (int i = 0; i < UWB_PREDICT_SAMPLES; i++) uwb_count_input[i] = qemu_rows[row][i];
    uint32_t idle = ticks(nothing);
    uint32_t busy = ticks(uwb_count_call);
    union { float f; uint32_t u; } answer = {uwb_count_output};
    print(answer.u);
    print(busy - idle);
  }
  semihost(0x18, (const void *)0x20026);
}
__attribute__((section(".vectors"), used)) const void *const table[2] = {&__StackTop, reset};
