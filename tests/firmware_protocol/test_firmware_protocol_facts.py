"""Facts that clients and bricks have to agree on."""

from __future__ import annotations

from firmware_protocol import (
    InputPort,
    MessageRead,
    ReadFile,
    bluetooth,
    encode_reply,
    encode_request,
    frame,
    limits,
    ultrasonic,
    usb,
)
from firmware_protocol.ultrasonic import UltrasonicCommand, UltrasonicRegister


def test_a_brick_is_recognised_on_usb():
    assert (usb.VENDOR_ID, usb.PRODUCT_ID) == (0x0694, 0x0002)
    assert (usb.ENDPOINT_OUT, usb.ENDPOINT_IN) == (0x01, 0x82)
    assert (usb.BOOT_VENDOR_ID, usb.BOOT_PRODUCT_ID) == (0x03EB, 0x6124)


def test_the_usb_serial_number_is_the_bluetooth_address():
    assert usb.bluetooth_address("0016530a0b0c") == "00:16:53:0A:0B:0C"
    assert usb.bluetooth_address("0016530A0B0C").startswith(bluetooth.ADDRESS_PREFIX)


def test_the_reported_address_is_spelled_without_its_seventh_byte():
    assert bluetooth.address_text(bytes.fromhex("0016530A0B0C00")) == "00:16:53:0A:0B:0C"


def test_the_longest_replies_fill_a_usb_packet():
    read = encode_reply(ReadFile, ReadFile.Reply(0, limits.READ_SIZE_USB, bytes(limits.READ_SIZE_USB)))
    message = encode_reply(MessageRead, MessageRead.Reply.of(0, b""))
    assert len(read) == len(message) == usb.PACKET_SIZE


def test_the_longest_read_reply_fills_the_bluetooth_buffer():
    read = encode_reply(ReadFile, ReadFile.Reply(0, 122, bytes(limits.READ_SIZE_BLUETOOTH)))
    assert len(read) == bluetooth.RECEIVE_BUFFER_SIZE
    assert len(frame(read)) == bluetooth.RECEIVE_BUFFER_SIZE + bluetooth.LENGTH_PREFIX_SIZE


def test_the_ultrasonic_sensor_is_asked_for_its_first_measurement():
    request = ultrasonic.read_register(InputPort.S4, UltrasonicRegister.MEASUREMENT)
    assert encode_request(request) == bytes.fromhex("00 0F 03 02 01 02 42")


def test_the_ultrasonic_sensor_is_told_to_measure_once():
    request = ultrasonic.write_register(
        InputPort.S4, UltrasonicRegister.COMMAND, UltrasonicCommand.SINGLE_SHOT
    )
    assert encode_request(request) == bytes.fromhex("00 0F 03 03 00 02 41 01")


def test_the_ultrasonic_sensor_introduces_itself_in_its_first_registers():
    texts = {
        UltrasonicRegister.VERSION: ultrasonic.VERSION,
        UltrasonicRegister.PRODUCT: ultrasonic.PRODUCT,
        UltrasonicRegister.KIND: ultrasonic.KIND,
    }
    assert [len(text) for text in texts.values()] == [8, 8, 8]
    assert len(ultrasonic.UNITS) == 7
