/* The brick round the firmware's portable sources: no motors turn, nothing is plugged in, the flash is memory.

   Commands on standard input, a letter and a 16-bit length each: U, B a telegram over USB, Bluetooth; T so many passes;
   Q whether the radio is busy. Answers alike: u, b what the firmware sends; q. */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include "stdconst.h"
#include "modules.h"
#include "m_sched.h"

#define FLASH 0x100000UL
#define FLASH_SIZE 0x40000UL
#define REGISTERS 0xFFF00000UL
#define REGISTERS_SIZE 0x100000UL
#define FLASH_READY 0xFFFFFF68UL
#define BATTERY_STEPS 580
#define INTRO_PASSES 9000
#define PIECE 128
#define FREE 16

void beside_wake(void);
int beside_busy(void);
UBYTE *beside_buffer(void);

static ULONG now_ms, sound_ends_ms;
static UBYTE packet[64], stream[0x10000], handles[FREE + 1];
static ULONG packet_size;
static int stream_size, stream_at, sending, listed;

static void say(char tag, const UBYTE *data, ULONG size)
{
  putchar(tag);
  putchar(size & 0xFF);
  putchar(size >> 8 & 0xFF);
  fwrite(data, 1, size, stdout);
}

void dTimerInit(void) {}
void dTimerExit(void) {}
ULONG dTimerRead(void) { return ++now_ms; } /* asked once a pass by a virtual machine that waits for it */
ULONG dTimerReadNoPoll(void) { return now_ms; }
ULONG dTimerReadHiRes(void) { return now_ms; }
ULONG dTimerGetNextMSTickCnt(void) { return 0; }

void dUsbInit(void) { memset(handles, FREE, sizeof handles); }
void dUsbExit(void) {}
void dUsbResetConfig(void) {}
void dUsbStoreBtAddress(UBYTE *address) {}
UBYTE dUsbIsConfigured(void) { return TRUE; }
UWORD dUsbCheckConnection(void) { return TRUE; }
ULONG dUsbWrite(const UBYTE *data, ULONG size) { say('u', data, size); return size; }
ULONG dUsbRead(UBYTE *data, ULONG most)
{
  ULONG size = packet_size;
  memcpy(data, packet, size);
  packet_size = 0;
  return size;
}
void dUsbInsertHandle(UBYTE handle)
{
  int at = 0;
  while (at < FREE && handles[at] != FREE) at++;
  handles[at] = handle;
}
void dUsbRemoveHandle(UBYTE handle)
{
  for (int at = 0; at < FREE; at++)
    if (handles[at] == handle) handles[at] = FREE;
}
UWORD dUsbGetNextHandle(void)
{
  int at = listed;
  while (at < FREE && handles[at] == FREE) at++;
  listed = at + 1;
  return at >= FREE ? NOMOREHANDLES : handles[at];
}
UWORD dUsbGetFirstHandle(void) { listed = 0; return dUsbGetNextHandle(); }

void dBtInit(void) {}
void dBtExit(void) {}
void dBtStartADConverter(void) {}
void dBtSetArm7CmdSignal(void) {}
void dBtClearArm7CmdSignal(void) {}
void dBtInitReceive(UBYTE *buffer, UBYTE mode) {}
void dBtSetBcResetPinLow(void) {}
void dBtSetBcResetPinHigh(void) {}
void dBtSendBtCmd(UBYTE a, UBYTE b, UBYTE c, UBYTE *d, UBYTE *e, UBYTE *f, UBYTE *g) {}
void dBtResetTimeOut(void) {}
void dBtClearTimeOut(void) {}
UBYTE dBtGetBc4CmdSignal(void) { return TRUE; }
UWORD dBtTxEnd(void) { return TRUE; }
UWORD dBtCheckForTxBuf(void) { return sending <= 0; }
void dBtSend(UBYTE *data, UBYTE size) { say('b', data, size); sending = 3; }
void dBtSendMsg(UBYTE *data, UBYTE size, UWORD whole)
{
  UBYTE framed[2 + 0x100] = {whole & 0xFF, whole >> 8};
  memcpy(framed + 2, data, size);
  say('b', framed, size + 2);
  sending = 3;
}
UWORD dBtReceivedData(UWORD *size, UWORD *to_go)
{
  int left = stream_size - stream_at;
  *size = left > PIECE ? PIECE : left;
  memcpy(beside_buffer(), stream + stream_at, *size);
  stream_at += *size;
  *to_go = stream_size - stream_at;
  return TRUE;
}

void dSoundInit(void) {}
void dSoundExit(void) {}
void dSoundVolume(UBYTE step) {}
UBYTE dSoundReady(void) { return now_ms >= sound_ends_ms; }
UBYTE dSoundStart(UBYTE *samples, UWORD size, UWORD rate, UBYTE format) { return TRUE; }
UBYTE dSoundStop(void) { sound_ends_ms = now_ms; return TRUE; }
UBYTE dSoundTone(UBYTE *melody, UWORD size, UBYTE volume) { return TRUE; }
void dSoundFreq(UWORD hertz, UWORD duration_ms, UBYTE volume) { sound_ends_ms = now_ms + duration_ms; }

void dButtonInit(UBYTE prescaler) {}
void dButtonExit(void) {}
void dButtonRead(UBYTE *buttons) { *buttons = 0; }
void dDisplayInit(void) {}
void dDisplayExit(void) {}
void dDisplayOn(UBYTE on) {}
UBYTE dDisplayUpdate(UWORD height, UWORD width, UBYTE *image) { return 0; }
void dHiSpeedInit(void) {}
void dHiSpeedExit(void) {}
void dHiSpeedSetupUart(void) {}
void dHiSpeedInitReceive(UBYTE *buffer) {}
void dHiSpeedSendData(UBYTE *data, UBYTE size) {}
void dHiSpeedReceivedData(UWORD *size) { *size = 0; }
void dIOCtrlInit(void) {}
void dIOCtrlExit(void) {}
void dIOCtrlTransfer(void) {}
void dIOCtrlSetPower(UBYTE power) {}
void dIOCtrlSetPwm(UBYTE pwm) {}

#define PIN(name) void name(UBYTE port) {}
PIN(dInputSetActive) PIN(dInputSet9v) PIN(dInputSetInactive) PIN(dInputSetDirOutDigi0) PIN(dInputSetDirOutDigi1)
PIN(dInputSetDirInDigi0) PIN(dInputSetDirInDigi1) PIN(dInputClearDigi0) PIN(dInputClearDigi1) PIN(dInputSetDigi0)
PIN(dInputSetDigi1) PIN(dInputClearColor100msTimer)
void dInputInit(void) {}
void dInputExit(void) {}
void dInputGetRawAd(UWORD *reading, UBYTE port)
{
  static const UWORD readings[] = {1023, 950, 700, 1023};
  *reading = readings[port];
}
void dInputRead0(UBYTE port, UBYTE *pins) {}
void dInputRead1(UBYTE port, UBYTE *pins) {}
UBYTE dInputGetColor(UBYTE port, UWORD *colour) { return FALSE; }
void dInputColorTx(UBYTE port, UBYTE data) {}
void dInputReadCal(UBYTE port, UBYTE *data) { *data = 0; }
UBYTE dInputCheckColorStatus(UBYTE port) { return FALSE; }
void dInputGetAllColors(void *raw, UBYTE status) {}
void dInputSetColorClkInput(void) {}
UBYTE dInputChkColor100msTimer(UBYTE port) { return FALSE; }
void dLowSpeedInit(void) {}
void dLowSpeedExit(void) {}
void dLowSpeedStartTimer(void) {}
void dLowSpeedStopTimer(void) {}
PIN(dLowSpeedInitPins)
UBYTE dLowSpeedSendData(UBYTE port, UBYTE *data, UBYTE size) { return TRUE; }
void dLowSpeedReceiveData(UBYTE port, UBYTE *data, UBYTE size) {}
UBYTE dLowSpeedComTxStatus(UBYTE port) { return 0; }
UBYTE dLowSpeedComRxStatus(UBYTE port) { return 0; }

static int memory(unsigned long at, unsigned long size)
{
  return mmap((void *)at, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == (void *)at;
}

static void pass(void)
{
  if (sending > 0) sending--;
  mSchedCtrl();
}

static int listen(void)
{
  int what = getchar(), size = getchar();
  size |= getchar() << 8;
  if (what == 'U') packet_size = fread(packet, 1, size, stdin);
  if (what == 'B') stream_size = fread(stream, 1, size, stdin), stream_at = 0;
  if (what == 'T') while (size--) pass();
  if (what == 'Q')
  {
    UBYTE busy = beside_busy();
    say('q', &busy, 1);
    fflush(stdout);
  }
  return what != EOF;
}

int main(void)
{
  if (!memory(FLASH, FLASH_SIZE) || !memory(REGISTERS, REGISTERS_SIZE)) return 1;
  memset((void *)FLASH, 0xFF, FLASH_SIZE);
  *(volatile unsigned *)FLASH_READY = 1;
  IoFromAvr.Battery = BATTERY_STEPS;
  dUsbInit();
  mSchedInit();
  for (int n = 0; n < INTRO_PASSES; n++)
  {
    beside_wake();
    pass();
  }
  while (listen());
  return 0;
}
